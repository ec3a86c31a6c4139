#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>
#include <utility>

#include "daemon/config/load.hpp"
#include "daemon/session/runtime.hpp"
#include "drivers/phantom/phantom_driver.hpp"
#include "sim/model/arm/register_arm_models.hpp"
#include "tests/scenario/two_real_arms.hpp"
#include "tests/support/willing_guards.hpp"

namespace thimble {
namespace {

using session::ArmSession;
using std::chrono::milliseconds;
using test::kTwoArms;
using testing::HasSubstr;

// A device of which is known how many there are.
class CountedHid final : public bus::HidDevice {
 public:
  CountedHid(std::unique_ptr<bus::HidDevice> below, int& open, const int& generation, int opened_in)
      : below_(std::move(below)), open_(open), generation_(generation), opened_in_(opened_in) {
    ++open_;
  }
  ~CountedHid() override { --open_; }
  CountedHid(const CountedHid&) = delete;
  CountedHid& operator=(const CountedHid&) = delete;
  IoStatus read_newest(bus::HidReport& out) noexcept override {
    return generation_ == opened_in_ ? below_->read_newest(out) : IoStatus::Disconnected;
  }
  IoStatus submit(std::span<const std::uint8_t> report) noexcept override {
    return below_->submit(report);
  }
  [[nodiscard]] bus::HidCounters counters() const noexcept override { return below_->counters(); }

 private:
  std::unique_ptr<bus::HidDevice> below_;
  int& open_;
  const int& generation_;
  int opened_in_;
};

// A bus on which somebody else holds a device for a while, and which counts who asks.
class ReluctantBus final : public bus::BusEnumerator {
 public:
  explicit ReluctantBus(sim::SimEnumerator& below) : below_(below) {}
  [[nodiscard]] std::vector<bus::BusDeviceInfo> list() override {
    std::vector<bus::BusDeviceInfo> devices = below_.list();
    for (bus::BusDeviceInfo& device : devices) {
      if (serial_numbers.count(device.address.text) == 0) continue;
      device.serial_number = serial_numbers.at(device.address.text);
    }
    return devices;
  }
  [[nodiscard]] std::optional<bus::BusEvent> poll_event() override { return below_.poll_event(); }
  [[nodiscard]] Result<std::unique_ptr<bus::HidDevice>> open_hid(
      const bus::DeviceAddress& address) override {
    ++tries;
    if (before_opening) std::exchange(before_opening, {})();
    if (is_busy || busy_tries-- > 0)
      return fail(Errc::Busy, address.text + " is held by somebody else");
    auto device = below_.open_hid(address);
    if (!device) return device;
    return std::make_unique<CountedHid>(*std::move(device), open, generation_,
                                        are_born_dead ? -1 : generation_);
  }

  // Every handle that is open now is of no use any more.
  void kill_handles() { ++generation_; }

  std::map<std::string, std::string> serial_numbers;  // instead of the models' own
  std::function<void()> before_opening{};             // happens once, when it was looked at already
  bool is_busy{false};
  int busy_tries{0};  // so many are refused from now on
  bool are_born_dead{false};
  int tries{0};
  int open{0};

 private:
  sim::SimEnumerator& below_;
  int generation_{0};
};

// The family's driver, which finds that an arm of the same name can do less than before.
class ChangingDriver final : public plugin::Driver {
 public:
  explicit ChangingDriver(const bool& is_weaker) : is_weaker_(is_weaker) {}
  [[nodiscard]] std::string_view name() const noexcept override { return below_->name(); }
  [[nodiscard]] std::vector<std::string> models() const override { return below_->models(); }
  [[nodiscard]] Result<void> check_files(const plugin::DriverSettings& settings) const override {
    return below_->check_files(settings);
  }
  [[nodiscard]] Result<void> probe(const bus::BusDeviceInfo& info,
                                   const plugin::DriverSettings& settings) const override {
    return below_->probe(info, settings);
  }
  [[nodiscard]] Result<std::unique_ptr<HapticDevice>> open(
      bus::BusEnumerator& buses, const bus::BusDeviceInfo& info,
      const plugin::DriverSettings& settings) const override {
    plugin::DriverSettings said = settings;
    if (is_weaker_) said.amplifier_max_a = 1.5;
    return below_->open(buses, info, said);
  }

 private:
  std::unique_ptr<plugin::Driver> below_{phantom::make_phantom_driver()};
  const bool& is_weaker_;
};

// Two arms on one bus that is no simulated one as far as the session can tell.
class HotPlug : public testing::Test {
 protected:
  HotPlug() {
    drivers_.add(std::make_unique<ChangingDriver>(is_weaker_));
    sim::register_arm_models(models_);
    for (const char* address : {"hid:left", "hid:right"}) plug(address);
    auto runtime = start();
    if (!runtime) throw std::runtime_error(runtime.error().message);
    sut_ = *std::move(runtime);
    run(0.02);
  }
  Result<std::unique_ptr<session::Runtime>> start() {
    const config::ConfigResult config = config::parse(kTwoArms, "two-arms.toml", {});
    if (!config) throw std::runtime_error(to_string(config.error().front()));
    session::RigParts parts{models_, drivers_};
    parts.real_buses = &bus_;
    parts.guards = &guards_;
    parts.real_clock = &clock_;
    parts.on_wait = [this](const Error& why) { troubles_.push_back(why); };
    return session::Runtime::create(*config, parts);
  }
  void plug(const char* address) {
    auto model = models_.find("phantom-vintage")->create_hid({.amplifier_max_a = 3, .seed = 1});
    EXPECT_TRUE(model);
    EXPECT_TRUE(plugs_.plug({address}, *std::move(model)));
  }
  void run(double s) {
    const MonotonicTime end = clock_.now() + from_seconds(s);
    while (clock_.now() < end) {
      static_cast<void>(clock_.sleep_until(clock_.now() + milliseconds(1)));
      for (const auto& arm : sut_->arms()) arm->session().loop().tick({});
      for (const Error& trouble : sut_->follow_buses(clock_.now())) troubles_.push_back(trouble);
    }
  }
  ArmSession& arm(std::size_t i) { return sut_->arms()[i]->session(); }
  OperatingState state(std::size_t i) { return arm(i).snapshot().frame.state; }

  bool is_weaker_{false};
  plugin::DriverRegistry drivers_;
  plugin::SimModelRegistry models_;
  sim::VirtualClock clock_;
  sim::SimEnumerator plugs_{clock_};
  ReluctantBus bus_{plugs_};
  test::WillingGuards guards_;
  std::unique_ptr<session::Runtime> sut_;
  std::vector<Error> troubles_;
};

TEST_F(HotPlug, ArmsOnOneBusEachHearOfTheirOwnReturn) {
  ASSERT_EQ(state(0), OperatingState::Calibrating);
  ASSERT_EQ(state(1), OperatingState::Calibrating);
  for (const char* address : {"hid:left", "hid:right"}) {
    ASSERT_TRUE(plugs_.unplug({address}));
  }
  run(3.3);  // so long that the next try by itself is more than a second away
  EXPECT_EQ(state(0), OperatingState::Lost);
  EXPECT_EQ(state(1), OperatingState::Lost);
  // The one that is asked last returns first.
  ASSERT_TRUE(plugs_.replug({"hid:right"}));
  ASSERT_TRUE(plugs_.replug({"hid:left"}));
  run(0.02);
  EXPECT_EQ(state(0), OperatingState::Configured);
  EXPECT_EQ(state(1), OperatingState::Configured);
  run(1.1);  // their controllers start
  EXPECT_EQ(state(0), OperatingState::Calibrating);
  EXPECT_EQ(state(1), OperatingState::Calibrating);
  EXPECT_EQ(troubles_.size(), 0U);
}

TEST_F(HotPlug, AReturnedArmThatSomebodyElseHoldsIsTriedAgainUntilItCanBeHad) {
  ASSERT_TRUE(plugs_.unplug({"hid:left"}));
  run(0.1);
  bus_.is_busy = true;
  ASSERT_TRUE(plugs_.replug({"hid:left"}));
  run(0.5);
  EXPECT_EQ(state(0), OperatingState::Lost);
  EXPECT_EQ(state(1), OperatingState::Calibrating) << "the other one is not concerned";
  EXPECT_THAT(arm(0).trouble(), AllOf(HasSubstr("left"), HasSubstr("held by somebody else")));
  EXPECT_EQ(arm(1).trouble(), "");
  bus_.is_busy = false;
  run(seconds(session::RetryPace::kLongest) + 0.5);
  EXPECT_EQ(state(0), OperatingState::Calibrating);
  EXPECT_EQ(arm(0).trouble(), "");
}

TEST_F(HotPlug, TriesBecomeRareAndNeverStop) {
  ASSERT_TRUE(plugs_.unplug({"hid:left"}));
  run(0.1);
  bus_.is_busy = true;
  bus_.tries = 0;
  ASSERT_TRUE(plugs_.replug({"hid:left"}));
  run(10);
  // At 0, 0.05, 0.15, 0.35, 0.75, 1.55, 3.15, 5.15, 7.15 and 9.15 s.
  EXPECT_EQ(bus_.tries, 10);
  EXPECT_EQ(troubles_.size(), 10U);
  run(10);
  EXPECT_EQ(bus_.tries, 15);
}

TEST_F(HotPlug, AnArmThatIsThereIsNotOpenedAgain) {
  const int at_start = bus_.tries;
  run(3);
  EXPECT_EQ(bus_.tries, at_start);
  EXPECT_EQ(at_start, 2);
}

// No event of the bus is needed for it: nobody plugs anything after the return.
TEST_F(HotPlug, TheOldDeviceIsPutAwayWithoutAnotherEvent) {
  ASSERT_TRUE(plugs_.unplug({"hid:left"}));
  run(0.05);
  ASSERT_TRUE(plugs_.replug({"hid:left"}));
  run(0.05);
  ASSERT_NE(state(0), OperatingState::Lost);
  EXPECT_EQ(bus_.open, 2);
}

TEST_F(HotPlug, AnArmWhoseHandlesDieAtOnceIsTriedLessAndLessOften) {
  run(0.1);
  bus_.are_born_dead = true;
  bus_.kill_handles();
  bus_.tries = 0;
  run(10);
  EXPECT_LE(bus_.tries, 2 * 12) << "as often as one that cannot be opened";
  EXPECT_GE(bus_.tries, 2 * 8);
  bus_.are_born_dead = false;
  run(seconds(session::RetryPace::kLongest) + 0.5);
  EXPECT_EQ(state(0), OperatingState::Calibrating);
  EXPECT_EQ(bus_.open, 2);
}

TEST_F(HotPlug, AnotherArmAtTheSamePlaceIsRefusedAndNotEvenOpened) {
  ASSERT_TRUE(plugs_.unplug({"hid:left"}));
  run(0.1);
  bus_.tries = 0;
  bus_.serial_numbers["hid:left"] = "ANOTHER-1";
  ASSERT_TRUE(plugs_.replug({"hid:left"}));
  run(3);
  EXPECT_EQ(state(0), OperatingState::Lost);
  EXPECT_EQ(bus_.tries, 0) << "nothing is sent to a stranger";
  EXPECT_THAT(arm(0).trouble(), AllOf(HasSubstr("left"), HasSubstr("ANOTHER-1"),
                                      HasSubstr("SIM-phantom-vintage"), HasSubstr("restart")));
  EXPECT_EQ(state(1), OperatingState::Calibrating) << "the other one is not concerned";

  ASSERT_TRUE(plugs_.unplug({"hid:left"}));
  bus_.serial_numbers.clear();
  run(0.1);
  ASSERT_TRUE(plugs_.replug({"hid:left"}));
  run(1.2);
  EXPECT_EQ(state(0), OperatingState::Calibrating) << "the one that left is welcome";
  EXPECT_EQ(arm(0).trouble(), "");
}

// What stands there now may be anything: it is looked at again.
TEST_F(HotPlug, AnArmThatIsPluggedInAnewBetweenTheLookAndTheOpeningIsNotOpenedAsWhatItWas) {
  ASSERT_TRUE(plugs_.unplug({"hid:left"}));
  run(0.1);
  bus_.tries = 0;
  bus_.before_opening = [&] {
    ASSERT_TRUE(plugs_.unplug({"hid:left"}));
    ASSERT_TRUE(plugs_.replug({"hid:left"}));
    EXPECT_EQ(bus_.open, 1);
  };
  ASSERT_TRUE(plugs_.replug({"hid:left"}));
  run(3);
  EXPECT_EQ(bus_.tries, 2) << "the first got nothing";
  EXPECT_EQ(bus_.open, 2);
  EXPECT_EQ(state(0), OperatingState::Calibrating);
}

TEST_F(HotPlug, AnArmThatReturnsWithoutTheSerialNumberThatItHadIsAnother) {
  ASSERT_TRUE(plugs_.unplug({"hid:left"}));
  bus_.serial_numbers["hid:left"] = "";
  run(0.1);
  ASSERT_TRUE(plugs_.replug({"hid:left"}));
  run(0.5);
  EXPECT_EQ(state(0), OperatingState::Lost);
  EXPECT_THAT(arm(0).trouble(), HasSubstr("no serial number"));
}

TEST_F(HotPlug, AnArmThatReturnsWithOtherLimitsIsRefused) {
  ASSERT_TRUE(plugs_.unplug({"hid:left"}));
  run(0.1);
  is_weaker_ = true;
  ASSERT_TRUE(plugs_.replug({"hid:left"}));
  run(0.5);
  EXPECT_EQ(state(0), OperatingState::Lost);
  EXPECT_THAT(arm(0).trouble(), AllOf(HasSubstr("limits"), HasSubstr("restart")));
  EXPECT_EQ(bus_.open, 1) << "and closed again";
}

// A handle that failed while its device stayed: the port opens no second one beside it.
TEST_F(HotPlug, AnArmWhoseHandleDiedIsOpenedAgainThoughItNeverLeft) {
  run(0.1);
  bus_.kill_handles();
  run(0.002);
  EXPECT_EQ(state(0), OperatingState::Lost);
  EXPECT_EQ(state(1), OperatingState::Lost);
  run(0.2);
  EXPECT_EQ(state(0), OperatingState::Calibrating);
  EXPECT_EQ(state(1), OperatingState::Calibrating);
  EXPECT_EQ(bus_.open, 2);
  EXPECT_EQ(troubles_.size(), 0U);
}

// The guard of a daemon that was killed holds the arm until the arm has taken its zeros.
TEST_F(HotPlug, ADaemonThatIsStartedAnewWaitsUntilTheGuardOfTheOneBeforeLetsGo) {
  sut_.reset();
  const MonotonicTime begun = clock_.now();
  bus_.busy_tries = 3;
  auto runtime = start();
  ASSERT_TRUE(runtime) << runtime.error().message;
  EXPECT_EQ(clock_.now() - begun, milliseconds(50 + 100 + 200));
  ASSERT_EQ(troubles_.size(), 1U) << "told once, before anything is there that has a status";
  EXPECT_THAT(troubles_[0].message, AllOf(HasSubstr("left"), HasSubstr("held by somebody else")));
  sut_ = *std::move(runtime);
  run(1.2);
  EXPECT_EQ(state(0), OperatingState::Calibrating);
  EXPECT_EQ(state(1), OperatingState::Calibrating);
}

TEST_F(HotPlug, AStartWaitsForEachArmThatSomebodyKeepsAndThenGoesOnWithoutIt) {
  sut_.reset();
  const MonotonicTime begun = clock_.now();
  bus_.is_busy = true;
  auto runtime = start();
  ASSERT_TRUE(runtime) << runtime.error().message;
  EXPECT_EQ(clock_.now() - begun, 2 * session::Runtime::kBusyPatience);
  EXPECT_THAT((*runtime)->arms()[0]->trouble(),
              AllOf(HasSubstr("'left'"), HasSubstr("held by somebody else")));
  EXPECT_THAT((*runtime)->arms()[1]->trouble(), HasSubstr("'right'"));
}

TEST_F(HotPlug, ALinkToAnotherHostIsRefusedInVirtualTime) {
  config::ArmConfig said;
  said.name = "far";
  said.device = "sim:phantom-vintage";
  said.amplifier_max_a = 3;
  const session::RigParts parts{models_, drivers_};
  const auto rig = session::ArmRig::create(said, {}, nullptr, parts);
  ASSERT_FALSE(rig);
  EXPECT_EQ(rig.error().code, Errc::Unsupported);
  EXPECT_THAT(rig.error().message, HasSubstr("far"));
}

}  // namespace
}  // namespace thimble
