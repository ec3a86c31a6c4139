#include <gtest/gtest.h>

#include <atomic>
#include <random>
#include <string>
#include <thread>

#include "daemon/servo/flight_recorder.hpp"

namespace thimble::servo {
namespace {

constexpr std::size_t kFrames = 16;
constexpr std::uint64_t kStops = 40'000;

// Every field speaks of the tick, so that a frame put together from two of them shows it.
ServoFrame numbered(std::uint64_t tick) {
  const auto value = static_cast<double>(tick);
  ServoFrame frame;
  frame.tick = tick;
  frame.now = MonotonicTime{Duration(tick)};
  frame.tip = {value, -value, 2 * value};
  frame.force = {-value, value, 3 * value};
  frame.generated_energy_j = value;
  frame.contacts = static_cast<std::uint32_t>(tick);
  frame.is_fading = tick % 2 == 0;
  return frame;
}

bool is_whole(const ServoFrame& frame) {
  const ServoFrame expected = numbered(frame.tick);
  return frame.now == expected.now && frame.tip == expected.tip && frame.force == expected.force &&
         frame.generated_energy_j == expected.generated_energy_j &&
         frame.contacts == expected.contacts && frame.is_fading == expected.is_fading;
}

// What the two threads tell each other beside the recorder. Seldom: each word that orders the two
// sides here hides from ThreadSanitizer whether the recorder does.
struct Pace {
  std::atomic<std::uint64_t> asked{0};     // writer: take everything, then answer
  std::atomic<std::uint64_t> answered{0};  // reader: nothing waits
  std::atomic<bool> is_over{false};
};

// A stop with this time came while the other memory surely was free: it lacks nothing.
constexpr MonotonicTime kWithRoom{Duration(1)};

// The servo: runs of any length, then one stop or several in one tick. Now and then it waits until
// the reader has taken everything, and now and then it sprints: stop upon stop while the reader is
// in the middle of taking one.
class Writer {
 public:
  Writer(FlightRecorder& sut, Pace& pace) : sut_(sut), pace_(pace) {}

  void play(std::uint64_t stops) {
    while (stops_ < stops) {
      const bool is_sprint = random_() % 2 == 0;
      const auto longest = is_sprint ? 2 : 2 * kFrames;
      for (auto turn = random_() % 64; turn > 0; --turn) {
        for (auto run = random_() % longest; run > 0; --run) sut_.record(numbered(++tick_));
        ++tick_;
        const auto at_once = 1 + (random_() % 8 == 0 ? random_() % 3 : 0);
        for (std::uint64_t i = 0; i < at_once; ++i) stop();
        if (random_() % 64 == 0) let_reader_finish();
      }
    }
  }
  void stop() {
    const MonotonicTime at = is_next_with_room_ ? kWithRoom : MonotonicTime{};
    // With nothing waiting, this stop leaves a free memory to the next one.
    is_next_with_room_ = is_all_taken_;
    is_all_taken_ = false;
    const auto number = static_cast<std::uint32_t>(++stops_);
    sut_.freeze(numbered(tick_), {FaultCode::Estop, at, tick_, number});
  }
  [[nodiscard]] std::uint64_t stops() const { return stops_; }

 private:
  void let_reader_finish() {
    pace_.asked.store(++asked_, std::memory_order_release);
    while (pace_.answered.load(std::memory_order_acquire) != asked_) std::this_thread::yield();
    is_all_taken_ = true;
  }

  FlightRecorder& sut_;
  Pace& pace_;
  std::mt19937 random_{5};
  std::uint64_t tick_{0};
  std::uint64_t stops_{0};
  std::uint64_t asked_{0};
  bool is_all_taken_{true};
  bool is_next_with_room_{false};
};

// The control thread, and a judge of what it is given.
class Reader {
 public:
  explicit Reader(FlightRecorder& sut) : sut_(sut) {}

  // False when nothing waited.
  bool take() {
    if (!sut_.is_frozen()) return false;
    const FlightStop stop = sut_.take();
    judge(stop);
    ++taken_;
    without_room_ += stop.without_room;
    last_ = stop.cause;
    return true;
  }

  [[nodiscard]] std::uint64_t taken() const { return taken_; }
  [[nodiscard]] std::uint64_t without_room() const { return without_room_; }
  [[nodiscard]] std::uint64_t with_room() const { return with_room_; }
  [[nodiscard]] const std::string& wrong() const { return wrong_; }

 private:
  void judge(const FlightStop& stop) {
    if (stop.frames.empty()) return note(stop, "has no frame");
    if (stop.frames.size() > kFrames) note(stop, "has more frames than there is room for");
    if (stop.cause.number <= last_.number) note(stop, "came before, or twice");
    if (stop.frames.back().tick != stop.cause.tick) note(stop, "does not end with its own tick");
    for (std::size_t i = 0; i < stop.frames.size(); ++i) {
      if (!is_whole(stop.frames[i])) note(stop, "has a torn frame");
      if (stop.frames[i].tick != stop.frames[0].tick + i) note(stop, "has a hole");
    }
    if (stop.cause.at != kWithRoom) return;
    ++with_room_;
    const std::uint64_t next_tick = last_.tick + (stop.cause.tick > last_.tick ? 1 : 0);
    const bool is_all = stop.frames.size() == kFrames || stop.frames[0].tick == next_tick;
    if (!is_all) note(stop, "lacks frames though there was room");
    if (stop.cause.number != last_.number + 1)
      note(stop, "lost one before it though there was room");
  }
  void note(const FlightStop& stop, const char* what) {
    if (wrong_.empty()) wrong_ = "stop " + std::to_string(stop.cause.number) + " " + what;
  }

  FlightRecorder& sut_;
  Fault last_{};
  std::uint64_t taken_{0};
  std::uint64_t without_room_{0};
  std::uint64_t with_room_{0};
  std::string wrong_;
};

TEST(FlightRecorderThreads, AnyPaceOfServoAndControlTearsNothingAndLosesNoStopUncounted) {
  FlightRecorder sut(kFrames);
  Pace pace;
  Writer servo(sut, pace);
  Reader control(sut);
  for (int i = 0; i < 3; ++i) servo.stop();  // before anybody looks: the third finds no room

  std::thread thread([&] {
    servo.play(kStops);
    pace.is_over.store(true, std::memory_order_relaxed);
  });
  std::mt19937 random(7);
  while (!pace.is_over.load(std::memory_order_relaxed)) {
    const std::uint64_t asked = pace.asked.load(std::memory_order_acquire);
    if (!control.take()) pace.answered.store(asked, std::memory_order_release);
    if (random() % 16 == 0) std::this_thread::yield();
  }
  thread.join();
  while (control.take()) {
  }
  // One counted between the last two looks is told with the next.
  servo.stop();
  while (control.take()) {
  }

  EXPECT_EQ(control.wrong(), "");
  EXPECT_EQ(control.taken() + control.without_room(), servo.stops());
  EXPECT_GT(control.with_room(), 0U) << "both paces were played";
  EXPECT_GT(control.without_room(), 0U) << "both paces were played";
}

}  // namespace
}  // namespace thimble::servo
