#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <map>
#include <random>

#include "drivers/cambus/board.hpp"
#include "drivers/cambus/cambus_page_wire.hpp"
#include "drivers/cambus/usb_port.hpp"
#include "sim/model/cam/usb_frames.hpp"
#include "tests/contract/cam_board_oracle.hpp"
#include "tests/support/usb_cam_board.hpp"

// Programs that are given up while they are on their way.
namespace thimble::cambus {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::size_t kPacket = usb::kFullSpeedPacketBytes;

// Claims a window of 4 GB, takes 40 ms for each write and does none: never silent, never done.
class SlowBoard final : public bus::UsbDevice {
 public:
  explicit SlowBoard(const Clock& clock) : clock_(clock) {
    words_[page::kMagic] = page::kMagicValue;
    words_[page::kVersion] = page::kVersionValue;
    words_[page::kWindowOffset] = page::kPageBytes;
    words_[page::kWindowBytes] = 0xffff0000;
    words_[page::kShape] = 0x010101 | 18U << 24;
    words_[page::kClockHz] = 25'000'000;
    words_[page::kIncarnation] = 1;
    words_[page::kRead] = page::kIsWaiting;
  }
  IoStatus read(std::uint8_t /*endpoint*/, bus::UsbPacket& out) noexcept override {
    if (replies_.transfers() == 0) answer_one();
    const auto size = replies_.next(out.bytes);
    if (!size) return IoStatus::NoData;
    out.size = *size;
    out.sequence = ++in_;
    out.arrived_at = clock_.now();
    return IoStatus::Ok;
  }
  IoStatus submit(std::uint8_t /*endpoint*/,
                  std::span<const std::uint8_t> packet) noexcept override {
    if (!requests_.take(packet)) return IoStatus::Ok;
    auto request = sim::cam::parse_usb_request(requests_.transfer());
    if (!request) return IoStatus::Ok;
    if (request->kind == usb::Kind::Begin) {
      waiting_.clear();
      replies_.add(sim::cam::make_usb_reply(*request, usb::Status::Done, {}));
    } else {
      waiting_.push_back(*std::move(request));
    }
    return IoStatus::Ok;
  }
  IoStatus start_control(const bus::UsbControlRequest& /*request*/) noexcept override {
    return IoStatus::Ok;
  }
  IoStatus read_control(bus::UsbControlReply& /*out*/) noexcept override {
    return IoStatus::NoData;
  }
  [[nodiscard]] bus::UsbCounters counters(std::uint8_t /*endpoint*/) const noexcept override {
    return {};
  }

 private:
  void answer_one() {
    if (waiting_.empty() || clock_.now() < next_) return;
    const sim::cam::UsbRequest request = std::move(waiting_.front());
    waiting_.pop_front();
    std::vector<std::uint32_t> payload;
    if (request.kind == usb::Kind::Read) {
      ++words_[page::kBeat];
      for (std::uint32_t i = 0; i < request.words; ++i) {
        payload.push_back(words_[request.offset + 4 * i]);
      }
    } else {
      next_ = clock_.now() + milliseconds(40);
    }
    replies_.add(sim::cam::make_usb_reply(request, usb::Status::Done, payload));
  }

  const Clock& clock_;
  std::map<std::uint32_t, std::uint32_t> words_;
  sim::cam::PacketCollector requests_{kPacket};
  sim::cam::PacketFeeder replies_{kPacket};
  std::deque<sim::cam::UsbRequest> waiting_;
  MonotonicTime next_{};
  std::uint64_t in_{0};
};

// Until it fails or says something.
Result<CamAnswer> play(Board& board, const CamSteps& steps, sim::VirtualClock& clock,
                       Duration at_most) {
  const auto started = board.start(steps, at_most, clock.now());
  if (!started) return tl::unexpected(started.error());
  while (true) {
    auto answer = board.poll(clock.now());
    if (!answer) return tl::unexpected(answer.error());
    if (*answer) return **std::move(answer);
    clock.run_for(microseconds(500));
  }
}

TEST(ASlowBoard, IsNotSentWhatWasGivenUp) {
  sim::VirtualClock clock;
  UsbBoardMatch match;
  match.packet_bytes = kPacket;
  const auto sut = test::wait_for_board({std::make_unique<SlowBoard>(clock), match}, clock).value();
  const std::vector<std::uint8_t> list(500'000);
  for (int i = 0; i < 10; ++i) {
    ASSERT_EQ(sut->put(0, list), IoStatus::Ok) << i;
    EXPECT_EQ(sut->put(0, list), IoStatus::Backlogged)
        << "one at a time, whatever it says it holds";
    for (int turn = 0; turn < 400; ++turn) {
      BoardStatus status;
      clock.run_for(microseconds(500));
      ASSERT_NE(sut->poll(clock.now(), status), IoStatus::Disconnected);
    }
    EXPECT_GT(sut->unwritten_bytes(), list.size() / 2) << "it is that slow";
    sut->drop_unsent();
    EXPECT_GT(sut->unwritten_bytes(), 0U) << "what it may have had stays";
    EXPECT_LE(sut->unwritten_bytes(), UsbPort::kMostLeftBytes);
  }
}

// Wherever it was: in the middle of a transfer, or with a doorbell that has not left.
TEST(AProgramThatIsGivenUp, DoesNotSpoilTheNext) {
  constexpr CamGeometry kSpace{{3, 3, 1}, CamDivision::StripY};
  const sim::cam::BoardOptions options{
      .shape = {{2, 1, 1}, 6}, .window_bytes = std::size_t{1} << 20, .is_paced = false};
  std::mt19937 random(7);
  sim::VirtualClock clock;
  sim::cam::SimUsbCamBoard board(clock, options);
  Board sut(test::open_usb_port(board, clock));
  int given_up = 0;
  for (int i = 0; i < 60; ++i) {
    test::CamBoardOracle oracle(kSpace);
    ASSERT_TRUE(sut.lay_out(kSpace));
    const Duration soon = microseconds(random() % 20'000);
    if (!play(sut, oracle.first_program(random), clock, soon)) ++given_up;
    oracle = test::CamBoardOracle(kSpace);
    ASSERT_TRUE(sut.lay_out(kSpace));
    const auto first = play(sut, oracle.first_program(random), clock, seconds(2));
    ASSERT_TRUE(first) << first.error().message << ' ' << i;
    const CamSteps steps = test::random_steps(random, kSpace.cells());
    const auto answer = play(sut, steps, clock, seconds(2));
    ASSERT_TRUE(answer) << answer.error().message << ' ' << i;
    const CamAnswer expected = oracle.play(steps);
    ASSERT_EQ(answer->counts, expected.counts) << i;
    ASSERT_EQ(answer->cells, expected.cells) << i;
  }
  EXPECT_GT(given_up, 20);
  EXPECT_EQ(board.model().counters().malformed, 0U);
}

}  // namespace
}  // namespace thimble::cambus
