#include "sim/model/falcon/falcon_arm_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "sim/model/falcon/register_falcon_model.hpp"
#include "sim/model/hand/person.hpp"
#include "sim/time/trace_hash.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/falcon_image.hpp"
#include "tests/unit/sim/falcon_host.hpp"

namespace thimble::sim {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

const std::string kIdle = "<AAAAAAAAAAAAAA>";
const std::string kHoming = "<AAAAAAAAAAAABA>";
// 1000 counts, 0x3e8, on every motor, and the same the other way.
const std::string kPushIn = "<IODAIODAIODAAA>";
const std::string kPushOut = "<IBMPIBMPIBMPAA>";

// An arm that weighs nothing and rubs nowhere: it stays where it is put.
FalconParameters still() {
  FalconParameters p = falcon_parameters();
  p.gravity_m_per_s2 = 0;
  return p;
}

std::array<int, 3> encoders(const std::string& reply) {
  std::array<int, 3> all{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t nibble = 4; nibble-- > 0;) {
      all[i] = 16 * all[i] + (reply.at(1 + 4 * i + nibble) - 'A');
    }
    if (all[i] >= 0x8000) all[i] -= 0x10000;
  }
  return all;
}

// Running, at 1 ms of latency.
class FalconArmModelTest : public testing::Test {
 protected:
  explicit FalconArmModelTest(const FalconParameters& parameters = still()) : host(parameters) {
    host.arm().load_firmware();
    host.wait(milliseconds(20));
    host.go_to_run_mode();
  }
  std::string reply(const std::string& request) {
    for (int ms = 0; ms < 5; ++ms) {
      if (const auto answer = host.exchange(ms == 0 ? request : kIdle)) return *answer;
    }
    ADD_FAILURE() << "no reply";
    return kIdle;
  }
  FalconHost host;
};

TEST(FalconModel, IsABareUsbDeviceUnderItsName) {
  plugin::SimModelRegistry models;
  register_falcon_model(models);
  ASSERT_NE(models.find("falcon"), nullptr);
  const auto model = models.find("falcon")->create({});
  ASSERT_TRUE(model);
  const bus::BusDeviceInfo info = plugin::describe(*model);
  EXPECT_EQ(info.kind, bus::BusKind::Usb);
  EXPECT_EQ(info.vendor_id, 0x0403);
  EXPECT_EQ(info.product_id, 0xcb48);
  ASSERT_EQ(info.endpoints.size(), 2U);
  EXPECT_EQ(info.endpoints[0].address, 0x81);
  EXPECT_EQ(info.endpoints[1].address, 0x02);
  EXPECT_NE(plugin::arm_backend(*model), nullptr);
}

TEST(FalconModel, IsLoadedOverTheBusAndRuns) {
  FalconHost host;
  ASSERT_TRUE(host.greet());
  ASSERT_TRUE(host.upload(test::falcon_image()));
  host.go_to_run_mode();
  for (int ms = 0; ms < 5; ++ms) host.exchange(kIdle);
  EXPECT_EQ(host.arm().processor().state(), FalconProcessor::State::Running);
  EXPECT_EQ(host.exchange(kIdle).value_or("").size(), 16U);
  EXPECT_EQ(host.arm().bridge().counters().framing_errors, 0U);
  EXPECT_EQ(host.arm().bridge().counters().overruns, 0U);
}

TEST(FalconModel, SaysNothingInRunModeWithoutFirmware) {
  FalconHost host;
  host.go_to_run_mode();
  for (int ms = 0; ms < 50; ++ms) EXPECT_EQ(host.exchange(kIdle), std::nullopt);
}

TEST(FalconModel, ReadsHowOftenAnUploadWasBegunWhateverBecameOfIt) {
  FalconHost host;
  const auto uploads = [&] {
    const auto all = host.arm().panel()->readings();
    EXPECT_EQ(all.size(), 1U);
    EXPECT_EQ(all.at(0).name, "uploads");
    return all.at(0).value;
  };
  EXPECT_EQ(uploads(), 0);
  host.arm().load_firmware();
  EXPECT_EQ(uploads(), 0) << "nobody sent that";
  host.arm().set_faults({.lost_echo = 700, .deaf_questions = 0}, {});
  ASSERT_TRUE(host.greet());
  EXPECT_FALSE(host.upload(test::falcon_image()));
  EXPECT_EQ(uploads(), 1);
  ASSERT_TRUE(host.greet());
  EXPECT_TRUE(host.upload(test::falcon_image()));
  host.arm().power_cycle();
  EXPECT_EQ(uploads(), 2);
  EXPECT_FALSE(host.arm().panel()->press(0, true));
}

TEST(FalconModel, TheBootLoadersAnswerComesInPiecesWhenTheLatencyIsShort) {
  FalconHost host;
  ASSERT_TRUE(host.greet());
  host.set(9, 1);
  host.set(3, 0x4138);
  host.set(1, 0x0101);
  host.wait(milliseconds(40));
  host.read();
  host.write(FalconHost::Bytes{0x0a, 0x43, 0x0d});
  std::size_t pieces = 0;
  for (int ms = 0; ms < 20; ++ms) {
    host.wait(milliseconds(1));
    if (!host.read().empty()) ++pieces;
  }
  EXPECT_GT(pieces, 1U);
}

TEST_F(FalconArmModelTest, ExchangesOnceAMillisecondAtALatencyOfOne) {
  int replies = 0;
  for (int ms = 0; ms < 1000; ++ms) replies += host.exchange(kIdle) ? 1 : 0;
  EXPECT_GE(replies, 998);
}

TEST_F(FalconArmModelTest, ExchangesOnceInSixteenAtALatencyOfSixteenWhenItWaits) {
  host.go_to_run_mode(16);
  int replies = 0;
  bool is_waiting = false;
  for (int ms = 0; ms < 1600; ++ms) {
    if (!is_waiting) host.write(kIdle);
    is_waiting = true;
    host.wait(milliseconds(1));
    if (host.read().empty()) continue;
    ++replies;
    is_waiting = false;
  }
  EXPECT_NEAR(replies, 100, 2);
}

TEST_F(FalconArmModelTest, HomesWhenItIsPushedInAndThenKnowsItsAngles) {
  ASSERT_TRUE(host.arm().move_tip_to({0, 0, 0.035}));
  reply(kHoming);
  EXPECT_EQ(reply(kHoming)[13], 'A') << "out there nothing is homed";
  for (double z_m = 0.034; z_m > -0.001; z_m -= 0.0005) {
    host.arm().move_tip_to({0, 0, z_m});
    host.wait(milliseconds(1));
  }
  EXPECT_EQ(reply(kHoming)[13], 'A') << "a jump is no movement";
  ASSERT_TRUE(host.arm().move_tip_to({0, 0, 0.02}));
  host.arm().push_tip({0, 0, -2});
  for (int ms = 0; ms < 400; ++ms) host.exchange(kHoming);
  host.arm().push_tip({});
  for (int ms = 0; ms < 200; ++ms) host.exchange(kHoming);
  EXPECT_EQ(static_cast<std::uint8_t>(reply(kHoming)[13]), 'A' + 0x70);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> within(-0.025, 0.025);
  for (int place = 0; place < 100; ++place) {
    ASSERT_TRUE(host.arm().move_tip_to({within(random), within(random), within(random)}));
    host.exchange(kIdle);
    host.exchange(kIdle);
    const std::array<int, 3> counts = encoders(reply(kIdle));
    for (std::size_t crank = 0; crank < 3; ++crank) {
      const double angle_deg = 0.03643 * counts[crank] + 35;
      EXPECT_NEAR(host.arm().plant().crank_rad()[crank] * 57.29578, angle_deg, 0.08);
    }
  }
}

TEST_F(FalconArmModelTest, PushesAsItIsToldAndNeverStopsByItself) {
  ASSERT_TRUE(host.arm().move_tip_to({0, 0, 0}));
  host.exchange(kPushIn);
  host.exchange(kPushIn);
  const Force3 in = host.arm().truth().motor_force;
  EXPECT_NEAR(in.z, -1000 * 10.0 / 4095, 0.05);
  EXPECT_NEAR(in.x, 0, 0.05);
  EXPECT_NEAR(in.y, 0, 0.05);
  host.exchange(kPushOut);
  host.exchange(kPushOut);
  ASSERT_TRUE(host.arm().move_tip_to({0, 0, 0}));
  EXPECT_NEAR(host.arm().truth().motor_force.z, -in.z, 0.05);
  host.wait(seconds(2));
  EXPECT_GT(host.arm().truth().motor_force.z, 0.5) << "no watchdog: the last command holds";
  EXPECT_EQ(host.arm().processor().firmware().counters().forces_before_homed, 4U);
}

TEST_F(FalconArmModelTest, AMisjudgedScaleIsAKnob) {
  FalconParameters strong = still();
  strong.newton_per_count *= 1.3;
  FalconHost other(strong);
  other.arm().load_firmware();
  other.go_to_run_mode();
  for (FalconHost* one : {&host, &other}) {
    one->exchange(kPushIn);
    one->exchange(kPushIn);
    one->arm().move_tip_to({0, 0, 0});
  }
  EXPECT_NEAR(other.arm().truth().motor_force.z / host.arm().truth().motor_force.z, 1.3, 1e-6);
}

TEST_F(FalconArmModelTest, APowerCutForgetsFirmwareAndForce) {
  reply(kPushIn);
  ASSERT_NE(host.arm().truth().motor_force, Force3{});
  host.arm().power_cycle();
  EXPECT_EQ(host.arm().truth().motor_force, Force3{});
  EXPECT_FALSE(host.arm().truth().is_amplifier_on);
  host.go_to_run_mode();
  EXPECT_EQ(host.exchange(kIdle), std::nullopt);
  ASSERT_TRUE(host.greet());
  EXPECT_TRUE(host.upload(test::falcon_image(3)));
}

TEST_F(FalconArmModelTest, TellsItsButtons) {
  host.arm().press_button(FalconButton::Left, true);
  host.arm().press_stylus_button(true);
  reply(kIdle);
  EXPECT_EQ(reply(kIdle)[13], 'A' + 0x0c);
  host.arm().press_button(FalconButton::Left, false);
  reply(kIdle);
  EXPECT_EQ(reply(kIdle)[13], 'A' + 0x04);
}

TEST_F(FalconArmModelTest, SpoilsItsRepliesOnDemand) {
  host.arm().set_faults({}, {.short_every = 3, .glue_every = 0});
  std::size_t cut = 0;
  for (int ms = 0; ms < 100; ++ms) cut += host.exchange(kIdle).value_or("").size() == 14 ? 1U : 0U;
  EXPECT_NEAR(static_cast<double>(cut), 33, 3);
  host.arm().set_faults({}, {.short_every = 0, .glue_every = 4});
  std::size_t glued = 0;
  for (int ms = 0; ms < 100; ++ms) {
    glued += host.exchange(kIdle).value_or("").size() == 32 ? 1U : 0U;
  }
  EXPECT_NEAR(static_cast<double>(glued), 25, 3);
}

TEST_F(FalconArmModelTest, NonFiniteForcesCountAndDoNothing) {
  host.arm().push_tip({std::nan(""), 0, 0});
  EXPECT_EQ(host.arm().non_finite_forces(), 1U);
  EXPECT_FALSE(host.arm().move_tip_to({std::nan(""), 0, 0}));
  EXPECT_FALSE(host.arm().move_tip_to({0, 0, 1}));
}

TEST_F(FalconArmModelTest, AllocatesNothingOnceItRuns) {
  FalconArmModel sut(falcon_parameters());
  sut.load_firmware();
  std::array<std::uint8_t, 64> in{};
  const FalconHost::Bytes request(kPushIn.begin(), kPushIn.end());
  sut.advance({});
  const std::uint64_t before = test::allocation_count();
  for (int round = 1; round < 4000; ++round) {
    sut.advance({round * microseconds(125)});
    if (round == 8) sut.control({.request = 9, .value = 1}, {});
    if (round == 9) sut.control({.request = 3, .value = 2}, {});
    if (round % 8 == 0) sut.out_packet(0x02, request);
    sut.in_packet(0x81, in);
  }
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_GT(sut.processor().firmware().counters().requests, 400U);
}

TEST(FalconModel, ThePersonPullsItOutAndPushesItHome) {
  FalconHost host;
  host.arm().load_firmware();
  host.go_to_run_mode();
  Person person(host.arm(), {});
  std::optional<std::string> last;
  for (int round = 0; round < 2; ++round) {
    for (int ms = 0; ms < 1200; ++ms) last = host.exchange(kHoming);
    EXPECT_EQ(static_cast<std::uint8_t>(last.value_or(kIdle)[13]) & 0x7fU, ('A' + 0x70U) & 0x7fU);
    host.arm().power_cycle();  // and once more, from where the hand has taken it
    host.arm().load_firmware();
    host.go_to_run_mode();
    person.begin_calibration();
  }
}

// Any bytes, requests and times from the host: the arm stays in one piece, and within what its
// motors can do.
std::uint64_t trace_of_noise(unsigned seed) {
  FalconArmModel sut(falcon_parameters());
  std::mt19937 random(seed);
  TraceHash trace;
  std::array<std::uint8_t, 64> bytes{};
  MonotonicTime now{};
  if (random() % 2 == 0) sut.load_firmware();
  for (int round = 0; round < 6000; ++round) {
    now = now + (random() % 50 == 0 ? milliseconds(random() % 30) : microseconds(125));
    sut.advance(now);
    for (std::uint8_t& byte : bytes) {
      byte = static_cast<std::uint8_t>(random() % 3 == 0 ? random() : 'A' + random() % 16);
    }
    bytes[0] = '<';
    bytes[15] = '>';
    if (random() % 20 == 0) {
      const auto request = static_cast<std::uint8_t>(random() % 12);
      const auto value = static_cast<std::uint16_t>(request == 3 ? 2 : random());
      sut.control({.request_type = static_cast<std::uint8_t>(random() % 5 == 0 ? 0xc0 : 0x40),
                   .request = request,
                   .value = value,
                   .length = 2},
                  bytes);
    }
    if (random() % 4 != 0) sut.out_packet(0x02, std::span(bytes).first(1 + random() % 64));
    const plugin::UsbAnswer in = sut.in_packet(random() % 9 == 0 ? 0x83 : 0x81, bytes);
    EXPECT_LE(in.size, 64U);
    trace.add(std::span(bytes).first(in.size));
    const plugin::ArmTruth truth = sut.truth();
    EXPECT_TRUE(is_finite(truth.tip) && is_finite(truth.tip_velocity));
    EXPECT_LT(norm(truth.tip_velocity), 10);
    EXPECT_LT(norm(truth.tip - Position3{}), 0.15);
    EXPECT_LT(std::abs(truth.mechanical_energy_j), 5);
    for (std::size_t axis = 0; axis < 3; ++axis) trace.add(truth.tip[axis]);
    if (testing::Test::HasFailure()) break;
  }
  EXPECT_EQ(sut.plant().standstills(), 0U);
  return trace.value();
}

TEST(FalconModel, NoiseFromTheHostNeverBreaksTheArmAndIsTheSameTwice) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    EXPECT_EQ(trace_of_noise(seed), trace_of_noise(seed));
  }
  EXPECT_NE(trace_of_noise(1), trace_of_noise(2));
}

}  // namespace
}  // namespace thimble::sim
