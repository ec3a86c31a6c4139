#include "drivers/falcon/boot_sequence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "tests/unit/falcon/scripted_loader.hpp"

namespace thimble::falcon {
namespace {

using std::chrono::milliseconds;
using test::Bytes;
using test::LoaderScript;
using test::ScriptedLoader;

Bytes any_image(std::size_t size, unsigned seed) {
  std::mt19937 random(seed);
  Bytes image(size);
  for (std::uint8_t& byte : image) {
    byte = static_cast<std::uint8_t>(test::between(random, 0, 255));
  }
  return image;
}

// A sequence and an arm, a millisecond at a time; the bridge sends a packet in each.
class Boot {
 public:
  explicit Boot(const LoaderScript& script, std::size_t image_bytes = 1000)
      : image(any_image(image_bytes, 1)), arm(script, image_bytes), sut(image) {}

  void step() {
    now_ = now_ + milliseconds(1);
    const BootOrder order = sut.next();
    if (order.kind == BootOrder::Kind::Request) sut.on_request_end(arm.on_request(order.request));
    if (order.kind == BootOrder::Kind::Packet) arm.on_packet(order.packet());
    const auto most = static_cast<std::size_t>(test::between(random_, 0, 62));
    sut.on_packet(arm.take_output(most), now_);
  }
  // True when it came to run within that time.
  bool runs_within(Duration time) {
    const MonotonicTime end = now_ + time;
    while (now_ < end && !sut.is_running()) step();
    return sut.is_running();
  }
  bool rests_within(Duration time) {
    const MonotonicTime end = now_ + time;
    while (now_ < end && sut.stage() != BootStage::Resting) step();
    return sut.stage() == BootStage::Resting;
  }

  Bytes image;
  ScriptedLoader arm;
  BootSequence sut;

 private:
  MonotonicTime now_{std::chrono::hours(3)};
  std::mt19937 random_{2};
};

TEST(BootSequence, UploadsTheImageToAnArmThatHasNone) {
  Boot boot({});
  ASSERT_TRUE(boot.runs_within(milliseconds(2000)));
  EXPECT_EQ(boot.arm.image, boot.image);
  EXPECT_EQ(boot.arm.uploads, 1);
  EXPECT_EQ(boot.sut.trouble(), BootTrouble::None);
}

// The sheet's 1.4, word for word: what is set in the bridge, in its order.
TEST(BootSequence, SetsTheBridgeAsTheSheetSays) {
  Boot boot({});
  ASSERT_TRUE(boot.runs_within(milliseconds(2000)));
  const std::vector<std::pair<int, int>> expected{
      {9, 1},      {3, 0x0002}, {0, 1},      {0, 2},                       // run mode?
      {0, 1},      {0, 2},      {9, 16},     {3, 0x4138}, {4, 8}, {2, 0},  // boot-loader?
      {1, 0x0200}, {1, 0x0100}, {1, 0x0101},                               //
      {1, 0x0100}, {3, 0x0015},                                            // upload
      {9, 1},      {3, 0x0002}, {0, 1},      {0, 2}};                      // run mode
  EXPECT_EQ(boot.arm.requests, expected);
}

TEST(BootSequence, LeavesAFirmwareAloneThatRuns) {
  Boot boot({.is_firmware_running = true});
  ASSERT_TRUE(boot.runs_within(milliseconds(50)));
  EXPECT_EQ(boot.arm.questions, 0);
  EXPECT_EQ(boot.arm.uploads, 0);
  EXPECT_EQ(boot.sut.next().kind, BootOrder::Kind::Nothing) << "the rest is the owner's";
}

TEST(BootSequence, AsksManyTimesBeforeItGivesUp) {
  Boot patient({.deaf_questions = 99});
  EXPECT_TRUE(patient.runs_within(std::chrono::seconds(8)));
  EXPECT_EQ(patient.arm.questions, 100);
  Boot silent({.is_there = false});
  ASSERT_TRUE(silent.rests_within(std::chrono::seconds(8)));
  EXPECT_EQ(silent.arm.questions, 100);
  EXPECT_EQ(silent.sut.trouble(), BootTrouble::NoLoader);
}

TEST(BootSequence, PassesOverWhatComesBeforeTheAnswer) {
  Boot boot({.says_zero_first = true});
  EXPECT_TRUE(boot.runs_within(milliseconds(2000)));
  EXPECT_EQ(boot.arm.questions, 1);
}

TEST(BootSequence, WithoutAnImageItSaysSoAndLooksAgain) {
  const Bytes none;
  BootSequence sut(none);
  ScriptedLoader arm({}, 0);
  MonotonicTime now{};
  int rests = 0;
  bool was_resting = false;
  for (int i = 0; i < 13'000; ++i) {
    now = now + milliseconds(1);
    const BootOrder order = sut.next();
    if (order.kind == BootOrder::Kind::Request) sut.on_request_end(arm.on_request(order.request));
    sut.on_packet({}, now);
    const bool is_resting = sut.stage() == BootStage::Resting;
    if (is_resting && !was_resting) ++rests;
    was_resting = is_resting;
    if (is_resting) {
      EXPECT_EQ(sut.trouble(), BootTrouble::NoImage);
    }
  }
  EXPECT_EQ(rests, 3) << "half a second of looking, five of rest";
  EXPECT_EQ(arm.questions, 0);
}

TEST(BootSequence, AnEchoThatIsLostCostsTheUpload) {
  Boot once({.spoilt_uploads = 1, .lost_echo = 500});
  ASSERT_TRUE(once.runs_within(std::chrono::seconds(4)));
  EXPECT_EQ(once.arm.uploads, 2);
  EXPECT_EQ(once.arm.image, once.image);
  EXPECT_EQ(once.sut.trouble(), BootTrouble::None);

  Boot last({.spoilt_uploads = 9, .lost_echo = 999});
  ASSERT_TRUE(last.runs_within(std::chrono::seconds(20)));
  EXPECT_EQ(last.arm.uploads, 10);

  Boot always({.spoilt_uploads = 1000, .lost_echo = 999});
  ASSERT_TRUE(always.rests_within(std::chrono::seconds(20)));
  EXPECT_EQ(always.arm.uploads, 10);
}

// The byte after a lost one comes in its place; of the last of all, none does.
TEST(BootSequence, TellsALostEchoFromAWrongOne) {
  Boot lost({.spoilt_uploads = 1000, .lost_echo = 999});
  ASSERT_TRUE(lost.rests_within(std::chrono::seconds(20)));
  EXPECT_EQ(lost.sut.trouble(), BootTrouble::EchoMissing);
  Boot wrong({.spoilt_uploads = 1000, .wrong_echo = 999});
  ASSERT_TRUE(wrong.rests_within(std::chrono::seconds(20)));
  EXPECT_EQ(wrong.sut.trouble(), BootTrouble::EchoWrong);
}

TEST(BootSequence, APacketThatIsCutCostsTheUpload) {
  Boot boot({.spoilt_uploads = 2, .short_packet = 100});
  ASSERT_TRUE(boot.runs_within(std::chrono::seconds(4)));
  EXPECT_EQ(boot.arm.uploads, 3);
  EXPECT_EQ(boot.arm.image, boot.image);
}

TEST(BootSequence, AnImageThatDoesNotRunIsToldApart) {
  Boot boot({.is_good_image = false});
  ASSERT_TRUE(boot.rests_within(std::chrono::seconds(30)));
  EXPECT_EQ(boot.sut.trouble(), BootTrouble::NotStarted);
  EXPECT_EQ(boot.arm.uploads, 10);
}

// A boot-loader in the middle of an upload echoes what it takes for more of it.
TEST(BootSequence, AnEchoIsNoFirmware) {
  Boot boot({.is_there = false, .echoes_in_run_mode = true});
  ASSERT_TRUE(boot.rests_within(std::chrono::seconds(8)));
  EXPECT_EQ(boot.sut.trouble(), BootTrouble::NoLoader);
}

TEST(BootSequence, ARefusedRequestIsTriedAgainAfterARest) {
  Boot boot({.refused_requests = 1});
  ASSERT_TRUE(boot.rests_within(milliseconds(10)));
  EXPECT_EQ(boot.sut.trouble(), BootTrouble::RequestRefused);
  EXPECT_TRUE(boot.runs_within(BootSequence::kRest + milliseconds(3000)));
  EXPECT_EQ(boot.sut.trouble(), BootTrouble::None);
}

bool is_knock(const BootOrder& order) {
  const auto knocks = test::reports_in({order.packet().begin(), order.packet().end()});
  return order.kind == BootOrder::Kind::Packet && knocks.size() == 1 &&
         knocks[0].encoder_counts == std::array<std::int16_t, 3>{};
}

TEST(BootSequence, AZeroLeavesBeforeAnythingElse) {
  const Bytes image = any_image(100, 3);
  BootSequence sut(image);
  EXPECT_TRUE(is_knock(sut.next()));
  EXPECT_EQ(sut.next().kind, BootOrder::Kind::Request);
  sut.on_packet({}, MonotonicTime{std::chrono::hours(3)});
  sut.on_request_end(bus::UsbOutcome::Done);
  sut.restart();
  EXPECT_TRUE(is_knock(sut.next())) << "and again after a restart";
}

// The bus has no time-outs: a request whose packet is lost never ends.
TEST(BootSequence, ARequestWithoutAnEndIsWaitedForWithZerosAndThenGivenUp) {
  const Bytes image = any_image(100, 3);
  BootSequence sut(image);
  (void)sut.next();
  ASSERT_EQ(sut.next().kind, BootOrder::Kind::Request);
  const MonotonicTime start{std::chrono::hours(3)};
  int knocks = 0;
  for (int ms = 0; ms < 500; ++ms) {
    sut.on_packet({}, start + milliseconds(ms));
    ASSERT_FALSE(sut.is_stuck()) << ms;
    const BootOrder order = sut.next();
    ASSERT_NE(order.kind, BootOrder::Kind::Request) << "one at a time";
    if (is_knock(order)) ++knocks;
  }
  EXPECT_EQ(knocks, 10);
  sut.on_packet({}, start + milliseconds(500));
  EXPECT_TRUE(sut.is_stuck());
}

TEST(BootSequence, ASlowRequestIsNoneWithoutAnEnd) {
  const Bytes image = any_image(100, 3);
  BootSequence sut(image);
  (void)sut.next();
  ASSERT_EQ(sut.next().kind, BootOrder::Kind::Request);
  sut.on_packet({}, MonotonicTime{std::chrono::hours(3)});
  sut.on_packet({}, MonotonicTime{std::chrono::hours(3)} + milliseconds(499));
  sut.on_request_end(bus::UsbOutcome::Done);
  sut.on_packet({}, MonotonicTime{std::chrono::hours(4)});
  EXPECT_FALSE(sut.is_stuck());
  (void)sut.next();  // a knock
  EXPECT_EQ(sut.next().kind, BootOrder::Kind::Request) << "the second one";
  sut.on_packet({}, MonotonicTime{std::chrono::hours(5)});
  EXPECT_FALSE(sut.is_stuck()) << "whose time begins with the first packet that follows";
}

TEST(BootSequence, EverySizeOfImageArrivesWhole) {
  for (const std::size_t size : {1U, 61U, 62U, 63U, 124U, 8492U}) {
    Boot boot({}, size);
    ASSERT_TRUE(boot.runs_within(std::chrono::seconds(6))) << size;
    ASSERT_EQ(boot.arm.image, boot.image) << size;
  }
}

TEST(BootSequence, RestartsFromTheBeginning) {
  Boot boot({});
  ASSERT_TRUE(boot.runs_within(milliseconds(2000)));
  boot.sut.restart();
  EXPECT_EQ(boot.sut.stage(), BootStage::Detecting);
  EXPECT_TRUE(boot.runs_within(milliseconds(100))) << "the firmware is still there";
  EXPECT_EQ(boot.arm.uploads, 1);
}

TEST(BootSequence, AnArmThatRanIsFoundAgainByAZeroAtOnce) {
  Boot boot({});
  ASSERT_TRUE(boot.runs_within(milliseconds(2000)));
  const std::size_t settings = boot.arm.requests.size();
  boot.sut.find_again();
  EXPECT_FALSE(boot.sut.is_running());
  EXPECT_TRUE(boot.runs_within(milliseconds(20)));
  EXPECT_EQ(boot.arm.requests.size(), settings) << "nothing is set anew";
  EXPECT_EQ(boot.arm.uploads, 1);
}

TEST(BootSequence, AnArmThatRanAndForgotItsFirmwareGetsItAgain) {
  Boot boot({});
  ASSERT_TRUE(boot.runs_within(milliseconds(2000)));
  boot.arm = ScriptedLoader({}, boot.image.size());
  boot.sut.find_again();
  EXPECT_FALSE(boot.runs_within(BootSequence::kSearch - milliseconds(10)));
  EXPECT_TRUE(boot.runs_within(milliseconds(2000)));
  EXPECT_EQ(boot.arm.uploads, 1);
}

// Nothing that a device does makes an order that cannot be, or an upload that leaves a byte out:
// each chunk is sent only when all before it came back.
TEST(BootSequence, AnyDeviceGetsOrdersThatCanBe) {
  std::mt19937 random(4);
  for (int round = 0; round < 60; ++round) {
    const Bytes image = any_image(static_cast<std::size_t>(test::between(random, 1, 300)), 5);
    LoaderScript script;
    script.spoilt_uploads = test::between(random, 0, 3);
    script.wrong_echo = static_cast<std::size_t>(test::between(random, 0, 300));
    script.deaf_questions = test::between(random, 0, 5);
    ScriptedLoader arm(script, image.size());
    BootSequence sut(image);
    MonotonicTime now{};
    for (int step = 0; step < 3000; ++step) {
      now = now + milliseconds(test::between(random, 0, 20));
      const BootOrder order = sut.next();
      if (order.kind == BootOrder::Kind::Request) {
        ASSERT_TRUE(bus::may_be_sent(order.request));
        const bool is_refused = test::between(random, 0, 200) == 0;
        const auto outcome = arm.on_request(order.request);
        sut.on_request_end(is_refused ? bus::UsbOutcome::Failed : outcome);
      }
      if (order.kind == BootOrder::Kind::Packet) {
        ASSERT_GE(order.size, 1U);
        ASSERT_LE(order.size, wire::kUploadChunkBytes);
        arm.on_packet(order.packet());
        ASSERT_LE(arm.image.size(), image.size());
        ASSERT_TRUE(std::equal(arm.image.begin(), arm.image.end(), image.begin()));
      }
      Bytes heard = arm.take_output(static_cast<std::size_t>(test::between(random, 0, 62)));
      if (test::between(random, 0, 30) == 0) {
        heard.push_back(static_cast<std::uint8_t>(test::between(random, 0, 255)));
      }
      sut.on_packet(heard, now);
      if (sut.is_running()) {
        ASSERT_EQ(arm.image, image);
        break;
      }
    }
  }
}

}  // namespace
}  // namespace thimble::falcon
