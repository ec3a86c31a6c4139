#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "daemon/config/load.hpp"
#include "daemon/session/plugins.hpp"
#include "daemon/session/runtime.hpp"
#include "tests/support/willing_guards.hpp"

// fallback = "simulated": who stands in, when the real arm may take over, and that nothing moves
// it unasked.
namespace thimble {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr const char* kOneArm = R"(
[[arm]]
name = "right"
device = "hid:right"
model = "phantom-vintage"
amplifier_max_a = 3.0
fallback = "simulated"
world = "box"
[arm.hand]
motion = "explore"
[[world]]
name = "box"
source = "box:3"
)";

// A bus whose devices somebody else may hold.
class HeldBus final : public bus::BusEnumerator {
 public:
  explicit HeldBus(sim::SimEnumerator& below) : below_(below) {}
  [[nodiscard]] std::vector<bus::BusDeviceInfo> list() override {
    ++looks;
    return below_.list();
  }
  [[nodiscard]] std::optional<bus::BusEvent> poll_event() override { return below_.poll_event(); }
  [[nodiscard]] Result<std::unique_ptr<bus::HidDevice>> open_hid(
      const bus::DeviceAddress& address) override {
    ++opened;
    if (is_busy) return fail(Errc::Busy, address.text + " is held by somebody else");
    return below_.open_hid(address);
  }
  bool is_busy{false};
  int looks{0};
  int opened{0};

 private:
  sim::SimEnumerator& below_;
};

class FallBack : public testing::Test {
 protected:
  void start(const std::vector<std::string>& overrides = {}) {
    const config::ConfigResult config = config::parse(kOneArm, "one-arm.toml", overrides);
    if (!config) throw std::runtime_error(to_string(config.error().front()));
    session::RigParts parts{plugins_.models, plugins_.drivers};
    parts.real_buses = &bus_;
    parts.guards = &guards_;
    parts.real_clock = &clock_;
    auto runtime = session::Runtime::create(*config, parts);
    if (!runtime) throw std::runtime_error(runtime.error().message);
    sut_ = *std::move(runtime);
  }
  void plug() {
    auto model = plugins_.models.find("phantom-vintage")->create_hid({.amplifier_max_a = 3});
    ASSERT_TRUE(model);
    ASSERT_TRUE(plugs_.plug({"hid:right"}, *std::move(model)));
  }
  // As the daemon: its servo, and then what came of the buses.
  void run(double s) {
    const MonotonicTime end = real_now() + from_seconds(s);
    while (real_now() < end) {
      // A stand-in's clock waits for the machine's, which is this one.
      static_cast<void>(rig().clock().sleep_until(rig().clock().now() + milliseconds(1)));
      rig().session().loop().tick({});
      static_cast<void>(sut_->pump(real_now()));
      for (const Error& trouble : sut_->follow_buses(real_now())) troubles_.push_back(trouble);
      for (auto& arrival : sut_->take_arrivals()) sut_->take_over(std::move(arrival));
    }
  }
  [[nodiscard]] MonotonicTime real_now() const { return clock_.now(); }
  session::ArmRig& rig() { return *sut_->arms().front(); }
  OperatingState state() { return rig().session().snapshot().frame.state; }
  std::string device() { return rig().session().config().device; }
  void want_active(bool wanted) { rig().session().controls().want_active = wanted; }

  session::Plugins plugins_;
  sim::VirtualClock clock_;
  sim::SimEnumerator plugs_{clock_};
  HeldBus bus_{plugs_};
  test::WillingGuards guards_;
  std::unique_ptr<session::Runtime> sut_;
  std::vector<Error> troubles_;
};

TEST_F(FallBack, ARealArmThatIsThereIsTaken) {
  plug();
  start();
  EXPECT_EQ(device(), "hid:right");
  EXPECT_EQ(rig().awaited(), nullptr);
}

TEST_F(FallBack, ASimulatedArmStandsInAndTheStatusSaysSo) {
  start();
  run(3);
  EXPECT_EQ(device(), "sim:phantom-vintage");
  EXPECT_EQ(state(), OperatingState::Active);
  ASSERT_NE(rig().awaited(), nullptr);
  EXPECT_EQ(rig().awaited()->arm().device, "hid:right");
  EXPECT_THAT(rig().awaited()->sentence(),
              AllOf(HasSubstr("'right'"), HasSubstr("hid:right is not there"),
                    HasSubstr("sim:phantom-vintage")));
  EXPECT_GT(rig().session().snapshot().total_contacts, 0U);
}

TEST_F(FallBack, ARealArmWaitsForAStandInThatIsActive) {
  start();
  run(3);
  plug();
  run(5);
  EXPECT_EQ(device(), "sim:phantom-vintage");
  EXPECT_EQ(state(), OperatingState::Active);
  EXPECT_EQ(bus_.opened, 0) << "it is not even opened";
  EXPECT_THAT(rig().awaited()->sentence(),
              AllOf(HasSubstr("is there"), HasSubstr("thimble deactivate right")));
}

TEST_F(FallBack, ARealArmTakesOverOnceTheStandInRestsAndIsNotActivatedUnasked) {
  start();
  run(3);
  plug();
  run(1);
  want_active(false);
  run(0.1);
  EXPECT_EQ(device(), "hid:right") << "at once, not at the next look by itself";
  EXPECT_EQ(rig().awaited(), nullptr);
  EXPECT_EQ(rig().sim_arm(), nullptr);
  plugin::ArmBackend& arm = *plugs_.arm_backend({"hid:right"});
  arm.press_calibration_button(true);
  run(1.5);  // its controller starts
  arm.press_calibration_button(false);
  run(0.5);
  arm.press_calibration_button(true);
  run(0.1);
  arm.press_calibration_button(false);
  run(1);
  EXPECT_EQ(state(), OperatingState::Inactive) << "though the configuration says activate";
  want_active(true);
  run(1);
  EXPECT_EQ(state(), OperatingState::Active);
  EXPECT_TRUE(troubles_.empty());

  ASSERT_TRUE(plugs_.unplug({"hid:right"}));
  run(3);
  EXPECT_EQ(state(), OperatingState::Lost);
  EXPECT_EQ(device(), "hid:right") << "nothing stands in for an arm that was driven";
  EXPECT_EQ(rig().session().snapshot().fault.number, 1U);
}

TEST_F(FallBack, AStandInThatRestsGivesWayWhenTheRealArmComes) {
  start({"arm.0.activate=false"});
  run(10);
  EXPECT_EQ(state(), OperatingState::Inactive);
  plug();
  run(0.01);
  EXPECT_EQ(device(), "hid:right");
}

TEST_F(FallBack, AStandInThatIsWantedAgainInTheSameMomentStays) {
  start();
  run(3);
  plug();
  run(0.1);
  want_active(false);
  while (state() != OperatingState::Inactive) {
    static_cast<void>(rig().clock().sleep_until(rig().clock().now() + milliseconds(1)));
    rig().session().loop().tick({});
  }
  want_active(true);
  run(1);
  EXPECT_EQ(device(), "sim:phantom-vintage");
  EXPECT_EQ(state(), OperatingState::Active);
}

TEST_F(FallBack, ARealArmThatCannotBeOpenedLeavesTheStandInAndIsTriedAgain) {
  start({"arm.0.activate=false"});
  run(2);
  bus_.is_busy = true;
  plug();
  run(10);
  EXPECT_EQ(device(), "sim:phantom-vintage");
  EXPECT_LE(bus_.opened, 12) << "less and less often";
  EXPECT_THAT(rig().awaited()->sentence(), HasSubstr("held by somebody else"));
  ASSERT_FALSE(troubles_.empty());
  EXPECT_THAT(troubles_.front().message, HasSubstr("'right'"));
  bus_.is_busy = false;
  run(seconds(session::RetryPace::kLongest) + 0.5);
  EXPECT_EQ(device(), "hid:right");
}

TEST_F(FallBack, ARealArmThatIsHeldAtTheStartIsLostAndHidesBehindNoSimulation) {
  plug();
  bus_.is_busy = true;
  start({"arm.0.activate=false"});
  run(0.1);
  EXPECT_EQ(device(), "hid:right");
  EXPECT_EQ(state(), OperatingState::Lost);
  EXPECT_EQ(rig().sim_arm(), nullptr);
  EXPECT_THAT(rig().trouble(), HasSubstr("held by somebody else"));
  bus_.is_busy = false;
  run(seconds(session::RetryPace::kLongest) + 0.5);
  EXPECT_NE(state(), OperatingState::Lost);
  EXPECT_EQ(rig().trouble(), "");
}

TEST_F(FallBack, ARealArmThatLeavesAgainIsLostAndNotReplaced) {
  start({"arm.0.activate=false"});
  run(2);
  plug();
  run(1);
  ASSERT_TRUE(plugs_.unplug({"hid:right"}));
  run(1);
  EXPECT_EQ(device(), "hid:right");
  EXPECT_EQ(state(), OperatingState::Lost);
}

TEST_F(FallBack, LooksByItselfEveryTwoSecondsWithoutAnyEvent) {
  start({"arm.0.activate=false"});
  run(20);
  EXPECT_GE(bus_.looks, 8);
  EXPECT_LE(bus_.looks, 24);
}

TEST(StandIn, IsTheArmsModelWithoutWhatBelongsToTheRealOne) {
  session::Plugins plugins;
  config::ArmConfig falcon;
  falcon.device = "usb:port-1-2";
  falcon.model = "falcon";
  falcon.firmware = "/there";
  falcon.newton_per_count = 0.002;
  const auto simulated = session::stand_in_for(falcon, plugins.models);
  ASSERT_TRUE(simulated);
  EXPECT_EQ(simulated->device, "sim:falcon-loaded");
  EXPECT_FALSE(simulated->firmware || simulated->newton_per_count);
  EXPECT_TRUE(simulated->hand);
  falcon.model = "gantry";
  const auto refused = session::stand_in_for(falcon, plugins.models);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, AllOf(HasSubstr("gantry"), HasSubstr("woody-2015")));
}

}  // namespace
}  // namespace thimble
