#include "cli/devices/arm_tables.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace thimble::devices_list {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

Entry arm_at(const std::string& address, const NeededKeys& keys) {
  Entry entry{address, "an arm", "", "", {}, {"woody-2015", "premium-1.5"}};
  entry.is_plugged_in_arm = true;
  entry.keys = keys;
  return entry;
}

const NeededKeys kOpenController{
    .model = true, .amplifier_max_a = true, .is_too_low_harmless = true, .limits = true};
const NeededKeys kFalcon{.firmware = true, .limits = true};

TEST(ArmTables, SayOfAnOpenControllerAllButWhichArmItIs) {
  EXPECT_EQ(arm_tables({arm_at("hid:A7", kOpenController)}, {}, "no daemon is running"),
            R"(# no daemon is running

# an arm
[[arm]]
name = "right"
device = "hid:A7"
# Which arm it drives, the controller cannot tell: take the # away from the one
# that it is.
# model = "woody-2015"
# model = "premium-1.5"
# Full scale of its amplifiers, as its firmware was built; too low only weakens
# it.
amplifier_max_a = 3.0
world = "box"
activate = false
[arm.limits]
force_newton = 1
)");
}

TEST(ArmTables, LeaveAnAmplifierToWhoKnowsWhatItsDriverMakesOfIt) {
  NeededKeys keys = kOpenController;
  keys.is_too_low_harmless = false;
  const std::string text = arm_tables({arm_at("hid:A7", keys)}, {}, "");
  EXPECT_THAT(text, HasSubstr("\n# amplifier_max_a =\n"));
  EXPECT_THAT(text, Not(HasSubstr("\namplifier_max_a")));
}

TEST(ArmTables, SayOfAPuckNothingOfForce) {
  const std::string text = arm_tables({arm_at("hid:P", {})}, {}, "");
  EXPECT_THAT(text, EndsWith("device = \"hid:P\"\nworld = \"box\"\nactivate = false\n"));
  EXPECT_THAT(text, Not(HasSubstr("model")));
}

TEST(ArmTables, NameTheFirmwareOfAFalcon) {
  EXPECT_THAT(arm_tables({arm_at("usb:F", kFalcon)}, {}, ""),
              HasSubstr("\nfirmware = \"nvent_firmware.bin\"\n"));
}

TEST(ArmTables, GiveEachArmANameThatNobodyHasAndTheWorldThatIsThere) {
  api::Status status;
  status.arms.resize(1);
  status.arms[0].name = "left";
  status.worlds.resize(1);
  status.worlds[0].name = "lake";
  const std::vector<Entry> entries(3, arm_at("hid:A7", kFalcon));
  const std::string text = arm_tables(entries, status, "");
  EXPECT_THAT(text, HasSubstr("name = \"right\""));
  EXPECT_THAT(text, HasSubstr("name = \"arm-3\""));
  EXPECT_THAT(text, HasSubstr("name = \"arm-4\""));
  EXPECT_THAT(text, Not(HasSubstr("name = \"left\"")));
  EXPECT_THAT(text, HasSubstr("world = \"lake\""));
  EXPECT_THAT(text, Not(HasSubstr("\"box\"")));
}

TEST(ArmTables, LeaveOutWhatIsUsedSimulatedOrNoArm) {
  std::vector<Entry> entries(3, arm_at("hid:A7", kFalcon));
  entries[0].users = {"right (active)"};
  entries[1].is_plugged_in_arm = false;
  entries[2] = Entry{"sim:a", "an arm", "", "", {}};
  EXPECT_EQ(arm_tables(entries, {}, "asked"),
            "# asked\n# No arm is plugged in that nobody uses.\n");
}

TEST(ArmTables, TellWhatIsInTheWay) {
  Entry entry = arm_at("hid:A7", kFalcon);
  entry.obstacle = "every user may open it";
  EXPECT_THAT(arm_tables({entry}, {}, ""), HasSubstr("# It cannot be used yet: every user may"));
}

// Whatever a device calls itself stays in a comment or in a string.
TEST(ArmTables, KeepWordsOfADeviceWhereTheyAre) {
  Entry entry = arm_at("hid:\"A\\7\n", {});
  entry.description = "evil\nactivate = true\r[arm.limits]\n\"\"\"";
  const std::string text = arm_tables({entry}, {}, "");
  EXPECT_THAT(text, HasSubstr("device = \"hid:\\\"A\\\\7?\"\n"));
  EXPECT_THAT(text, Not(HasSubstr("\nactivate = true")));
  EXPECT_THAT(text, Not(HasSubstr("\n[arm.limits]")));
}

}  // namespace
}  // namespace thimble::devices_list
