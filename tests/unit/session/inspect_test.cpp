#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "drivers/falcon/firmware_image.hpp"
#include "hal/bus/device_name.hpp"
#include "tests/support/falcon_image.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/session/inspect_testing.hpp"

namespace thimble::session {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;
using Table = config::Objection::Table;

class InspectSphere : public ::testing::Test {
 protected:
  [[nodiscard]] std::vector<config::Objection> inspected() const {
    return inspect(config, {models, drivers});
  }
  plugin::SimModelRegistry models;
  plugin::DriverRegistry drivers;
  config::Config config{with_sphere()};
};

TEST_F(InspectSphere, LooksForNoRealDeviceAndObjectsToABusThatIsNotThere) {
  config::ArmConfig arm;
  arm.world = "hello";
  for (const char* device :
       {"hid:1", "usb:1-4", "usb:FA1CON", "serial:1234567", "hid:1-4.2:1.1",
        "usb:pci-0000:00:14.0-usb-0:1.4", "usb:platform-vhci_hcd.0-usbv3-0:1",
        "hid:pci-0000:00:14.0-usb-0:4:1.1", "hid:0003:1234:0006.0004", "serial:A_b+c-1.2:1.1"}) {
    arm.device = device;
    config.arms = {arm};
    EXPECT_TRUE(inspected().empty()) << device;
  }
  arm.device = "pci:0";
  config.arms = {arm};
  ASSERT_EQ(inspected().size(), 1U);
  EXPECT_EQ(inspected()[0].key, "device");
}

TEST_F(InspectSphere, ObjectsToAnAddressThatNoBusCouldGive) {
  config::ArmConfig arm;
  arm.world = "hello";
  for (const char* device : {"serial:/dev/ttyACM0",
                             "hid:/dev/hidraw0",
                             "usb:1/4",
                             "hid:A B",
                             "hid:\xc3\xa4",
                             "serial:A\n",
                             "usb:0403:cb48",
                             "usb:1-4:1.0",
                             "usb:1-4:1.1",
                             "usb:A7:1.2",
                             "hid:256f:c635",
                             "usb:pci-0000:00:14.0",
                             "usb:pci-0000:00:14.0-usb-0:4:1.1",
                             "usb:pci-0000:00:14.0-usb-0:",
                             "hid:pci-0000:00:14.0-usb-0:4:1.0",
                             "serial:16C0:0483",
                             "hid:1-4:1.0",
                             "usb:-usb-0:4",
                             "usb:x-usb-0:.",
                             "usb:x-usb-0:1..2",
                             "usb:x-usb-0:1.",
                             "usb:x-usb-0:0",
                             "usb:x-usb-0:1.04"}) {
    arm.device = device;
    config.arms = {arm};
    const auto sut = inspected();
    ASSERT_EQ(sut.size(), 1U) << device;
    EXPECT_EQ(sut[0].key, "device");
    EXPECT_NE(sut[0].message.find("thimble devices"), std::string::npos) << sut[0].message;
  }
}

// Whatever number a device says: what a bus makes an address of can be configured.
TEST(DeviceName, HasEveryLetterOfASerialNumber) {
  for (const char letter : bus::kSerialLetters) EXPECT_TRUE(bus::is_device_name({&letter, 1}));
  EXPECT_FALSE(bus::is_device_name(""));
}

TEST_F(InspectSphere, HasNothingAgainstIt) { EXPECT_TRUE(inspected().empty()); }

TEST_F(InspectSphere, HasNothingAgainstAWorldThatRuns) {
  for (const char* source : {"life", "crystal"}) {
    config.worlds[0] = {};
    config.worlds[0].name = "hello";
    config.worlds[0].source = source;
    config.worlds[0].automaton.emplace();
    EXPECT_TRUE(inspected().empty()) << source;
    config.worlds[0].constraint_model = config::ConstraintModel::Simple;
    ASSERT_EQ(inspected().size(), 1U);
    EXPECT_EQ(inspected()[0].key, "constraint_model");
  }
}

TEST_F(InspectSphere, LooksAtTheFileOfAFieldAndAtWhatGoesWithIt) {
  const testing_support::TemporaryFolder folder;
  const std::string path = folder / "ball.nrrd";
  config.worlds[0] = {};
  config.worlds[0].name = "hello";
  config.worlds[0].source = path;
  config.worlds[0].field.emplace();
  ASSERT_EQ(inspected().size(), 1U);
  EXPECT_THAT(inspected()[0].message, StartsWith(path));
  folder.write("ball.nrrd",
               "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 2 2\nencoding: text\n\n"
               "1 1 1 1 1 1 1 -1\n");
  EXPECT_TRUE(inspected().empty());
  config.worlds[0].constraint_model = config::ConstraintModel::Simple;
  config::ArmConfig arm;
  arm.device = "usb:1-4";
  arm.world = "hello";
  arm.coupling.scheme = config::CouplingScheme::ThesisLiteral;
  config.arms = {arm};
  EXPECT_EQ(inspected().size(), 2U) << "the model, and the scheme";
}

TEST_F(InspectSphere, ObjectsToTheModelThatWorksOnCells) {
  config.worlds[0].constraint_model = config::ConstraintModel::Simple;
  const auto sut = inspected();
  ASSERT_EQ(sut.size(), 1U);
  EXPECT_EQ(sut[0].table, Table::World);
  EXPECT_EQ(sut[0].key, "constraint_model");
  EXPECT_NE(sut[0].message.find("works on cells"), std::string::npos);
}

TEST_F(InspectSphere, HasNothingAgainstAListener) {
  config.worlds[0].listen = config::UdpEndpoint{"127.0.0.1", 0};
  EXPECT_TRUE(inspected().empty());
}

TEST_F(InspectSphere, ObjectsToTheSchemeOfAnArmThatTouchesItAndOfNoOther) {
  config::ArmConfig arm;
  arm.coupling.scheme = config::CouplingScheme::ThesisLiteral;
  arm.world = "another";
  config.arms.push_back(arm);
  arm.world = "hello";
  config.arms.push_back(arm);
  const auto sut = inspected();
  ASSERT_EQ(sut.size(), 1U);
  EXPECT_EQ(sut[0].table, Table::Arm);
  EXPECT_EQ(sut[0].index, 1U);
  EXPECT_EQ(sut[0].key, "coupling");
}

TEST_F(InspectSphere, ObjectsToOneThatCannotBe) {
  config.worlds[0].sphere->radius_m = -1;
  const auto sut = inspected();
  ASSERT_EQ(sut.size(), 1U);
  EXPECT_EQ(sut[0].key, "source");
}

// A driver may want more than a device: a clock, for one.
TEST(InspectModels, HasNothingAgainstAnySimulatedArm) {
  const Plugins plugins;
  for (const plugin::SimModelEntry& model : plugins.models.entries()) {
    config::Config config = with_falcon();
    config.arms[0].device = "sim:" + model.name;
    config.arms[0].amplifier_max_a = 3;
    for (const config::Objection& objection : inspect(config, {plugins.models, plugins.drivers})) {
      ADD_FAILURE() << model.name << ": " << objection.key << ": " << objection.message;
    }
  }
}

class InspectFiles : public InspectRealArm {
 protected:
  InspectFiles() { arm().device = "usb:1-4"; }
  [[nodiscard]] std::vector<std::string> objections() const {
    std::vector<std::string> all;
    for (const config::Objection& one : inspect_files(config, plugins.drivers)) {
      EXPECT_EQ(one.table, Table::Arm);
      EXPECT_EQ(one.index, 0U);
      all.push_back(one.key + ": " + one.message);
    }
    return all;
  }
  void expect_whatever_the_model_is_called(const testing::Matcher<std::string>& objection) {
    for (const std::optional<std::string>& model :
         {std::optional<std::string>("falcon"), std::optional<std::string>()}) {
      arm().model = model;
      EXPECT_THAT(objections(), ElementsAre(objection));
      EXPECT_THAT(InspectRealArm::objections(), IsEmpty()) << "a start does not wait for a file";
    }
  }
  const testing_support::TemporaryFolder folder;
};

TEST_F(InspectFiles, ObjectsToAKeyThatIsNone) {
  arm().key_file = folder.write("key", "secret").string();
  std::filesystem::permissions(*arm().key_file, std::filesystem::perms::owner_read);
  EXPECT_THAT(objections(), ElementsAre(AllOf(StartsWith("key_file: "), HasSubstr("no key"))));
  arm().key_file = folder.write("good", std::string(64, 'a')).string();
  std::filesystem::permissions(*arm().key_file, std::filesystem::perms::owner_read);
  EXPECT_THAT(objections(), IsEmpty());
}

TEST_F(InspectFiles, HasNothingAgainstNoneAndAgainstTheOneThatWasMeant) {
  EXPECT_THAT(objections(), IsEmpty());
  const std::vector<std::uint8_t> image = test::falcon_image();
  arm().firmware =
      folder.write("image", {reinterpret_cast<const char*>(image.data()), image.size()}).string();
  arm().firmware_sha256 = falcon::sha256_of(image);
  EXPECT_THAT(objections(), IsEmpty());
  arm().firmware_sha256 = std::string(64, '0');
  expect_whatever_the_model_is_called(
      AllOf(StartsWith("firmware: "), HasSubstr("is not the firmware that was meant")));
  arm().firmware_sha256.reset();
  expect_whatever_the_model_is_called(
      AllOf(StartsWith("firmware: "), HasSubstr("is none of the known firmwares")));
}

TEST_F(InspectFiles, ObjectsToOneThatIsNotThereOrIsNoFile) {
  arm().firmware = "/nowhere/falcon.bin";
  expect_whatever_the_model_is_called(
      AllOf(StartsWith("firmware: there is no firmware at"), HasSubstr("nvent_firmware.bin")));
  arm().firmware = "/";
  expect_whatever_the_model_is_called(HasSubstr("is not a regular file"));
  arm().model = "polhem-1";
  EXPECT_THAT(objections(), IsEmpty()) << "its driver reads none";
}

TEST_F(InspectFiles, DoubtsAFalconWhoseForceNothingCouldCut) {
  const auto doubts = [&] { return doubts_of(config, plugins.drivers); };
  arm().name = "right";
  arm().firmware = "/somewhere";
  arm().device = "usb:1-4";
  EXPECT_THAT(doubts(), ElementsAre(StartsWith("arm 'right' may go on pushing")));
  config.safety = config::SafetyConfig{};
  EXPECT_THAT(doubts(), ElementsAre(HasSubstr("set safety.enable")));
  config.safety->enable = "3";
  config.safety->chip = "sim:chain";
  EXPECT_THAT(doubts(), ElementsAre(HasSubstr("set safety.enable"))) << "which cuts nothing";
  config.safety->chip = "cp2112_gpio";
  EXPECT_THAT(doubts(), IsEmpty());
  config.safety.reset();
  arm().device = "sim:falcon-loaded";
  EXPECT_THAT(doubts(), IsEmpty());
  arm().device = "hid:A7";
  EXPECT_THAT(doubts(), IsEmpty());
}

TEST_F(InspectFiles, DoubtsAFalconWithoutFirmwareAndNoOtherArm) {
  const auto doubts = [&] { return doubts_of(config, plugins.drivers); };
  config.safety = config::SafetyConfig{};
  config.safety->enable = "3";
  config.servo.rate_hz = 4000;
  arm().name = "right";
  arm().firmware.reset();
  arm().device = "usb:1-4";
  for (const std::optional<std::string>& model :
       {std::optional<std::string>("falcon"), std::optional<std::string>()}) {
    arm().model = model;
    EXPECT_THAT(doubts(), ElementsAre(StartsWith("arm 'right' lacks arm.firmware")));
  }
  arm().firmware = "/somewhere";
  EXPECT_THAT(doubts(), IsEmpty());
  arm().firmware.reset();
  arm().device = "sim:falcon-loaded";
  EXPECT_THAT(doubts(), IsEmpty());
  arm().device = "hid:A7";
  EXPECT_THAT(doubts(), IsEmpty());
  arm().model = "polhem-1";
  arm().device = "usb:1-4";
  EXPECT_THAT(doubts(), IsEmpty());
}

TEST_F(InspectFiles, DoubtsADeviceThatWasCopiedFromAPage) {
  arm().name = "right";
  for (const char* copied : {"hid:SERIAL", "usb:PORT", "serial:SERIAL"}) {
    arm().device = copied;
    EXPECT_THAT(doubts_of(config, plugins.drivers),
                testing::Contains(AllOf(StartsWith("arm 'right' has the device"), HasSubstr(copied),
                                        HasSubstr("thimble devices"))));
  }
  for (const char* other : {"hid:SERIAL-7", "hid:7", "sim:phantom-vintage", ":", ""}) {
    arm().device = other;
    EXPECT_THAT(doubts_of(config, plugins.drivers),
                testing::Not(testing::Contains(HasSubstr("stands in the pages"))));
  }
}

TEST_F(InspectFiles, DoubtsASimulatedFalconWithoutFirmware) {
  arm().name = "right";
  arm().device = "sim:falcon";
  EXPECT_THAT(doubts_of(config, plugins.drivers),
              ElementsAre(AllOf(StartsWith("arm 'right' lacks arm.firmware"),
                                HasSubstr("without a firmware file use sim:falcon-loaded"))));
  arm().firmware = "/somewhere";
  EXPECT_THAT(doubts_of(config, plugins.drivers), IsEmpty());
  arm().firmware.reset();
  for (const char* other : {"sim:falcon-loaded", "sim:phantom-vintage"}) {
    arm().device = other;
    EXPECT_THAT(doubts_of(config, plugins.drivers), IsEmpty());
  }
}

TEST_F(InspectFiles, DoubtsAServoThatIsTooSlowForAllSamplesOfAFalcon) {
  const auto doubts = [&] { return doubts_of(config, plugins.drivers); };
  config.safety = config::SafetyConfig{};
  config.safety->enable = "3";
  arm().name = "right";
  arm().firmware = "/somewhere";
  arm().model = "falcon";
  arm().device = "usb:1-4";
  EXPECT_THAT(doubts(), IsEmpty()) << "its driver's own";
  config.servo.rate_hz = 1000;
  EXPECT_THAT(doubts(), ElementsAre(AllOf(StartsWith("arm 'right' does not give all of its 1000"),
                                          HasSubstr("at servo.rate_hz = 1000:"),
                                          HasSubstr("leave servo.rate_hz out"))));
  config.servo.rate_hz = 2000;
  EXPECT_THAT(doubts(), ElementsAre(HasSubstr("at servo.rate_hz = 2000:")));
  config.servo.rate_hz = 4000;
  EXPECT_THAT(doubts(), IsEmpty());
  config.servo.rate_hz = 1000;
  arm().model = "polhem-1";
  EXPECT_THAT(doubts(), IsEmpty());
}

class InspectFalcon : public ::testing::Test {
 protected:
  void expect_objection(std::string_view key, std::string_view says) const {
    const auto objections = inspect(config, {plugins.models, plugins.drivers});
    ASSERT_EQ(objections.size(), 1U);
    EXPECT_EQ(objections[0].table, Table::Arm);
    EXPECT_EQ(objections[0].key, key);
    EXPECT_NE(objections[0].message.find(says), std::string::npos) << objections[0].message;
  }
  Plugins plugins;
  config::Config config{with_falcon()};
};

TEST_F(InspectFalcon, HasNothingAgainstIt) {
  EXPECT_TRUE(inspect(config, {plugins.models, plugins.drivers}).empty());
}

TEST_F(InspectFalcon, ObjectsToAFirmwareThatIsNotThere) {
  config.arms[0].firmware = "/nowhere/falcon.bin";
  expect_objection("firmware", "nvent_firmware.bin");
}

TEST_F(InspectFalcon, ObjectsToAScaleThatMakesItTooStrong) {
  config.arms[0].newton_per_count = 1e-4;
  expect_objection("newton_per_count", "stronger than it was asked for");
}

}  // namespace
}  // namespace thimble::session
