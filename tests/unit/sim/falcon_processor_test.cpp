#include "sim/model/falcon/falcon_processor.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <random>
#include <string>
#include <vector>

#include "tests/support/falcon_image.hpp"

namespace thimble::sim {
namespace {

using std::chrono::milliseconds;
using Bytes = std::vector<std::uint8_t>;
using State = FalconProcessor::State;

constexpr double kLoad = 3e6 / 21;
const Bytes kQuestion{0x0a, 0x43, 0x0d};
const Bytes kAnswer{0x0a, 0x44, 0x2c, 0x0d};

class FalconProcessorTest : public testing::Test {
 protected:
  // What comes back, at whatever speed.
  Bytes say(const Bytes& bytes, double baud) {
    Bytes back;
    for (const std::uint8_t byte : bytes) {
      now = now + serial_byte_time(baud);
      sut.receive(now, {byte, baud}, {});
      while (sut.next_arrival() <= now + milliseconds(5)) {
        const SerialByte sent = sut.take_arrived();
        back.push_back(receive_at(sent, baud).value);
      }
    }
    return back;
  }
  void lines(bool dtr, bool rts = false) { sut.set_lines(now, dtr, rts); }
  void wait(Duration time) { now = now + time; }
  void wake() {
    lines(false);
    lines(true);
    wait(FalconProcessor::kListensAfter);
  }
  void greet() {
    wake();
    ASSERT_EQ(say(kQuestion, 9600), kAnswer);
    lines(false);
    ASSERT_EQ(sut.state(), State::BootRom);
  }
  void load(const Bytes& image) {
    greet();
    ASSERT_EQ(say({0x41}, kLoad), Bytes{0x41});
    ASSERT_EQ(say(image, kLoad), image);
    wait(FalconProcessor::kRunsAfter);
  }
  Bytes request(std::string_view text) {
    const Bytes bytes(text.begin(), text.end());
    return say(bytes, 1.5e6);
  }

  FalconProcessor sut;
  MonotonicTime now{};
};

TEST_F(FalconProcessorTest, LoadsInTheKnownOrderAndRuns) {
  load(test::falcon_image());
  EXPECT_EQ(request("<CAAAAAAAAAAAAA>").size(), 16U);
  EXPECT_EQ(sut.state(), State::Running);
  EXPECT_EQ(sut.motor_counts(), (std::array<int, 3>{2, 0, 0}));
  EXPECT_EQ(sut.counters().starts, 1U);
}

TEST_F(FalconProcessorTest, SaysNothingBeforeDtrHasRisenAndItHasWokenUp) {
  EXPECT_EQ(say(kQuestion, 9600), Bytes{});
  lines(true);
  EXPECT_EQ(say(kQuestion, 9600), Bytes{});
  wait(FalconProcessor::kListensAfter);
  EXPECT_EQ(say(kQuestion, 9600), kAnswer);
  EXPECT_EQ(sut.counters().questions, 1U);
}

TEST_F(FalconProcessorTest, SaysNothingAtAnotherSpeedOrWithRtsHigh) {
  wake();
  EXPECT_EQ(say(kQuestion, kLoad), Bytes{});
  EXPECT_EQ(say(kQuestion, 4800), Bytes{});
  lines(true, true);
  EXPECT_EQ(say(kQuestion, 9600), Bytes{});
  lines(true, false);
  EXPECT_EQ(say(kQuestion, 9600), kAnswer);
}

TEST_F(FalconProcessorTest, HearsAQuestionInNoise) {
  wake();
  EXPECT_EQ(say({0x0a, 0x0a, 0x43, 0x43, 0x0a, 0x43, 0x0d}, 9600), kAnswer);
  EXPECT_EQ(say({0x0d, 0x0a, 0x43}, 9600), Bytes{});
  EXPECT_EQ(say({0x0d}, 9600), kAnswer);
}

TEST_F(FalconProcessorTest, DtrThatFallsUnansweredLeavesItDeaf) {
  wake();
  lines(false);
  EXPECT_EQ(say({0x41}, kLoad), Bytes{});
  EXPECT_EQ(sut.state(), State::Deaf);
}

TEST_F(FalconProcessorTest, WantsTheMarkBeforeTheImage) {
  greet();
  EXPECT_EQ(say({0x40, 0xaa, 0x08}, kLoad), Bytes{});
  EXPECT_EQ(say({0x41}, 9600), Bytes{});
  EXPECT_EQ(say({0x41}, kLoad), Bytes{0x41});
}

TEST_F(FalconProcessorTest, AnotherKeyStopsItUntilTheNextReset) {
  greet();
  say({0x41}, kLoad);
  EXPECT_EQ(say({0xaa, 0x10, 0x00}, kLoad), Bytes{0xaa});
  EXPECT_EQ(sut.state(), State::Stuck);
  load(test::falcon_image(2));
  EXPECT_EQ(request("<AAAAAAAAAAAAAA>").size(), 16U);
}

TEST_F(FalconProcessorTest, AnImageThatIsCutNeverRuns) {
  Bytes image = test::falcon_image();
  image.pop_back();
  load(image);
  request("<AAAAAAAAAAAAAA>");
  EXPECT_EQ(sut.state(), State::Loading);
  EXPECT_EQ(sut.counters().starts, 0U);
}

// Random talk, half of it meant; whoever waits for packets relies on the bound.
TEST_F(FalconProcessorTest, NeverSendsMoreThanItSaysItWill) {
  std::mt19937 dice(3);
  const std::vector<Bytes> words{kQuestion, {0x0a, 0x43}, {0x0d}, {0x41}, test::falcon_image()};
  const std::string request = "<AAAAAAAAAAAAAA>";
  const std::array<double, 3> speeds{9600, kLoad, 1.5e6};
  std::array<int, 7> seen{};
  int exact = 0;
  sut.firmware().set_faults({.short_every = 0, .glue_every = 3});
  for (int step = 0; step < 20'000; ++step) {
    const unsigned what = dice() % 16;
    if (what == 0) lines(dice() % 2 == 0);
    if (what == 1 && dice() % 40 == 0) sut.start_firmware();
    Bytes talk = words[dice() % (what == 2 ? words.size() : words.size() - 1)];
    if (what >= 8) talk.assign(request.begin(), request.begin() + 1 + dice() % 16);
    const double baud = dice() % 4 == 0 ? speeds[dice() % 3] : speeds[what >= 8 ? 2 : dice() % 2];
    wait(milliseconds(dice() % 30));
    ++seen[static_cast<std::size_t>(sut.state())];
    const std::size_t most = sut.most_to_arrive(talk.size());
    const std::size_t came = say(talk, baud).size();
    ASSERT_LE(came, most) << "step " << step << ", state " << static_cast<int>(sut.state());
    exact += came == most && came > 0 ? 1 : 0;
  }
  for (const int count : seen) EXPECT_GT(count, 20);
  EXPECT_GT(exact, 300);
}

TEST_F(FalconProcessorTest, LosesAnEchoOnce) {
  sut.set_faults({.lost_echo = 5, .deaf_questions = 0});
  const Bytes image = test::falcon_image();
  Bytes without = image;
  without.erase(without.begin() + 5);
  greet();
  say({0x41}, kLoad);
  EXPECT_EQ(say(image, kLoad), without);
  load(image);
}

TEST_F(FalconProcessorTest, IsDeafToQuestionsOnDemand) {
  sut.set_faults({.lost_echo = {}, .deaf_questions = 2});
  wake();
  EXPECT_EQ(say(kQuestion, 9600), Bytes{});
  EXPECT_EQ(say(kQuestion, 9600), Bytes{});
  EXPECT_EQ(say(kQuestion, 9600), kAnswer);
}

TEST_F(FalconProcessorTest, ForgetsItsFirmwareAndItsForceWithPowerAndWithDtr) {
  load(test::falcon_image());
  request("<CAAAAAAAAAAAAA>");
  sut.power_up();
  EXPECT_EQ(sut.motor_counts(), (std::array<int, 3>{}));
  EXPECT_EQ(request("<CAAAAAAAAAAAAA>"), Bytes{});
  load(test::falcon_image());
  request("<CAAAAAAAAAAAAA>");
  EXPECT_EQ(sut.motor_counts()[0], 2);
  lines(true);
  EXPECT_EQ(sut.motor_counts()[0], 0);
}

// Whatever is done in whatever order, it runs only what was asked for in the known order.
TEST_F(FalconProcessorTest, RunsAfterNoOtherOrder) {
  const Bytes image = test::falcon_image(1, 1);
  std::mt19937 random(5);
  std::uint64_t expected = 0;
  int step = 0;  // of the known order that were done in a row
  bool dtr = false;
  for (int i = 0; i < 20'000; ++i) {
    const unsigned what = step == 4 ? 4 : static_cast<unsigned>(random()) % 5;
    if (what == 0) {  // DTR rises
      if (!dtr) step = 1;
      lines(dtr = true);
      wait(FalconProcessor::kListensAfter);
    } else if (what == 1) {  // the question
      say(kQuestion, 9600);
      if (step == 1) step = 2;
    } else if (what == 2) {  // DTR falls
      if (dtr && step < 4) step = step == 2 ? 3 : 0;
      lines(dtr = false);
    } else if (what == 3) {  // the mark
      say({0x41}, kLoad);
      if (step == 3) step = 4;
    } else {
      say(image, kLoad);
      wait(FalconProcessor::kRunsAfter);
      const bool runs = !request("<AAAAAAAAAAAAAA>").empty();
      ASSERT_EQ(runs, step == 4 || step == 5) << "step " << step << ", round " << i;
      if (step == 4) ++expected;
      step = runs ? 5 : step;
      if (step == 3) step = 6;  // the image may contain a mark: then it is loading something
    }
    if (step == 6) {
      lines(false);
      lines(dtr = true);
      wait(FalconProcessor::kListensAfter);
      step = 1;
    }
  }
  EXPECT_EQ(sut.counters().starts, expected);
  EXPECT_GT(expected, 50U);
}

}  // namespace
}  // namespace thimble::sim
