#include <gmock/gmock.h>

#include <memory>
#include <optional>
#include <string>

#include "tests/unit/session/inspect_testing.hpp"

namespace thimble::session {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;

const char* device_on(bus::BusKind kind) {
  if (kind == bus::BusKind::Usb) return "usb:1-4";
  return kind == bus::BusKind::Serial ? "serial:NOBODY" : "hid:NOBODY";
}

TEST_F(InspectRealArm, HasNothingAgainstWhatADriverCouldOpenWhenItComes) {
  EXPECT_THAT(objections(), IsEmpty()) << "a puck, which tells its model itself";
  for (const auto& driver : plugins.drivers.drivers()) {
    const bool has_amplifiers = driver->used_settings().value().amplifier_max_a;
    for (const std::string& model : driver->models()) {
      const std::vector<bus::BusKind> kinds = driver->buses_of(model).value();
      for (const bus::BusKind kind : kinds) {
        arm().model = model;
        arm().device = device_on(kind);
        arm().amplifier_max_a = has_amplifiers ? std::optional<double>(3) : std::optional<double>();
        EXPECT_THAT(objections(), IsEmpty()) << model << " at " << arm().device;
      }
    }
  }
}

TEST_F(InspectRealArm, ObjectsToAModelOnABusThatNothingDrivesItOn) {
  arm().amplifier_max_a = 3;
  const auto expect = [&](const char* device, const char* model, const std::string& buses) {
    arm().device = device;
    arm().model = model;
    EXPECT_THAT(
        objections(),
        ElementsAre(AllOf(StartsWith("device: expected an address that begins with " + buses),
                          HasSubstr("a '" + std::string(model) + "' on another bus"),
                          HasSubstr(device))));
  };
  for (const char* model : {"polhem-1", "aluhaptics-2"}) expect("serial:12", model, "\"hid:\", ");
  expect("usb:1-4", "phantom-vintage", "\"hid:\" or \"serial:\"");
  expect("hid:1-5", "falcon", "\"usb:\"");
  expect("usb:1-5", "spacemouse", "\"hid:\"");
  expect("serial:A7", "spacemouse-compact", "\"hid:\"");
  arm().fallback = config::Fallback::Simulated;
  expect("serial:12", "polhem-1", "\"hid:\"");
}

TEST_F(InspectRealArm, ObjectsToKeysThatDoNothingThere) {
  const auto refused = [](const std::string& driver, const std::string& key) {
    return StartsWith(key + ": " + driver + ": " + key + " is not a setting of this arm");
  };
  const auto say_all = [&] {
    arm().amplifier_max_a = 3;
    arm().newton_per_count = 0.01;
    arm().firmware = "/falcon.bin";
    arm().firmware_sha256 = std::string(64, '0');
  };
  say_all();
  arm().model = "phantom-vintage";
  EXPECT_THAT(objections(),
              ElementsAre(refused("phantom", "firmware"), refused("phantom", "firmware_sha256"),
                          refused("phantom", "newton_per_count")));
  arm().fallback = config::Fallback::Simulated;
  EXPECT_THAT(objections(), SizeIs(3)) << "the real one comes later";
  arm().fallback = config::Fallback::None;
  arm().model = "spacemouse";
  EXPECT_THAT(objections(), SizeIs(4));
  arm().device = "usb:1-4";
  arm().model = "falcon";
  EXPECT_THAT(objections(), ElementsAre(refused("falcon", "amplifier_max_a")));
  arm().model.reset();
  EXPECT_THAT(objections(), ElementsAre(refused("falcon", "amplifier_max_a")));
}

TEST_F(InspectRealArm, ObjectsToAKeyWithoutAModelOnlyWhereNobodyOnThatBusUsesIt) {
  arm().newton_per_count = 0.01;
  EXPECT_THAT(objections(), ElementsAre(StartsWith("newton_per_count: phantom, spacemouse: ")));
  arm().device = "usb:1-4";
  EXPECT_THAT(objections(), IsEmpty()) << "a Falcon";
}

// Of a configuration for a real arm an override makes a simulated one.
TEST_F(InspectRealArm, LetsASimulatedArmHaveTheKeysOfAnother) {
  arm().hand.emplace();
  arm().device = "sim:falcon-loaded";
  arm().amplifier_max_a = 3;
  EXPECT_THAT(objections(), IsEmpty());
  arm().device = "sim:phantom-vintage";
  arm().newton_per_count = 0.01;
  EXPECT_THAT(objections(), IsEmpty());
}

// Tells nothing but the one bus that it has, as those of plugins do.
class SilentDriver final : public plugin::Driver {
 public:
  explicit SilentDriver(std::optional<std::vector<bus::BusKind>> buses, std::string name = "silent")
      : buses_(std::move(buses)), name_(std::move(name)) {}
  [[nodiscard]] std::string_view name() const noexcept override { return name_; }
  [[nodiscard]] std::vector<std::string> models() const override { return {}; }
  [[nodiscard]] std::optional<std::vector<bus::BusKind>> buses_of(
      std::string_view /*model*/) const override {
    return buses_;
  }
  [[nodiscard]] Result<void> check_files(const plugin::DriverSettings&) const override {
    return {};
  }
  [[nodiscard]] Result<void> probe(const bus::BusDeviceInfo&,
                                   const plugin::DriverSettings&) const override {
    return fail(Errc::NotMine, {});
  }
  [[nodiscard]] Result<std::unique_ptr<HapticDevice>> open(
      bus::BusEnumerator&, const bus::BusDeviceInfo&,
      const plugin::DriverSettings&) const override {
    return fail(Errc::NotMine, {});
  }

 private:
  std::optional<std::vector<bus::BusKind>> buses_;
  std::string name_;
};

// No driver gives it a watchdog.
TEST_F(InspectRealArm, DoubtsTheForceOfAFalconWhoeverDrivesIt) {
  const auto doubts = [&] { return doubts_of(config, plugins.drivers); };
  plugins.drivers.add_from_outside(std::make_unique<SilentDriver>(std::nullopt, "falcon"));
  arm().device = "usb:A7";
  arm().model = "falcon";
  EXPECT_THAT(doubts(), ElementsAre(StartsWith("arm 'right' may go on pushing")));
  arm().model.reset();
  EXPECT_THAT(doubts(), IsEmpty()) << "it may be any device";
}

TEST_F(InspectRealArm, LeavesWhatAPluginMayDriveAlone) {
  plugins.drivers.add(std::make_unique<SilentDriver>(std::vector<bus::BusKind>{bus::BusKind::Hid}));
  arm().device = "hid:A7";
  arm().model = "gantry";
  arm().newton_per_count = 0.01;
  arm().amplifier_max_a = 3;
  EXPECT_THAT(objections(), IsEmpty());
  arm().device = "usb:1-4";
  EXPECT_THAT(objections(), ElementsAre(HasSubstr("begins with \"hid:\", since nothing drives")));
  plugins.drivers.add(std::make_unique<SilentDriver>(std::nullopt));
  EXPECT_THAT(objections(), IsEmpty());
}

TEST_F(InspectRealArm, ObjectsToAModelThatNoDriverHas) {
  arm().model = "gantry";
  EXPECT_THAT(objections(),
              ElementsAre(AllOf(StartsWith("model: expected one of"), HasSubstr("polhem-1"),
                                HasSubstr("spacemouse-compact"), HasSubstr("\"gantry\""))));
}

TEST_F(InspectRealArm, ObjectsToAnArmWithAmplifiersWhoseModelNobodyCanTell) {
  arm().amplifier_max_a = 3;
  EXPECT_THAT(objections(), ElementsAre(StartsWith("model: expected beside amplifier_max_a")));
}

TEST_F(InspectRealArm, ObjectsToWhatItsDriverWouldRefuseWhenItComes) {
  arm().model = "phantom-vintage";
  EXPECT_THAT(objections(),
              ElementsAre(StartsWith("amplifier_max_a: phantom: amplifier_max_a is missing")));
  arm().amplifier_max_a = 3;
  arm().limits.rise_newton_per_s = 2000;
  EXPECT_THAT(objections(), ElementsAre(StartsWith("limits: ")));
  arm().limits.rise_newton_per_s = 1000;
  arm().amplifier_max_a.reset();
  arm().device = "usb:1-4";
  arm().model = "falcon";
  arm().newton_per_count = 1e-4;
  EXPECT_THAT(objections(), ElementsAre(StartsWith("newton_per_count: ")));
}

// What a plugin would have brought is not known while it is refused; that is the mistake to mend.
TEST_F(InspectRealArm, BlamesThePluginThatDidNotLoadAndNotWhatItMayHaveBrought) {
  config.daemon.plugins = {"/nowhere/gantry.so"};
  arm().hand.emplace();
  const auto expect = [&] {
    const auto all = inspect_with_plugins(config, plugins);
    ASSERT_EQ(all.size(), 1U) << all[0].message;
    EXPECT_EQ(all[0].key, "plugins");
    EXPECT_EQ(all[0].message, "/nowhere/gantry.so: there is no such file");
  };
  arm().device = "sim:gantry";
  expect();
  arm().device = "hid:A7";
  arm().model = "gantry";
  expect();
  arm().fallback = config::Fallback::Simulated;
  expect();
  arm().device = "serial:12";
  arm().model = "polhem-1";
  arm().amplifier_max_a = 3;
  arm().fallback = config::Fallback::None;
  expect();
  config.daemon.plugins.clear();
  arm().device = "sim:gantry";
  EXPECT_EQ(inspect_with_plugins(config, plugins).size(), 1U) << "nobody has it";
}

}  // namespace
}  // namespace thimble::session
