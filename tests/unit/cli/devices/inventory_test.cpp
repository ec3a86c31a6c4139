#include "cli/devices/inventory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/json.hpp>

#include "cli/devices/report.hpp"
#include "daemon/session/plugins.hpp"

namespace thimble::devices_list {
namespace {

using testing::Field;
using testing::HasSubstr;
using testing::SizeIs;

// The ids of nobody's arm.
class Stranger : public plugin::SimHidModel {
 public:
  [[nodiscard]] bus::BusDeviceInfo describe() const override {
    bus::BusDeviceInfo info;
    info.kind = bus::BusKind::Hid;
    info.vendor_id = 0x46d;
    return info;
  }
  [[nodiscard]] Duration frame_period() const noexcept override {
    return std::chrono::milliseconds(1);
  }
  void advance(MonotonicTime) noexcept override {}
  void out_report(std::span<const std::uint8_t>) noexcept override {}
  std::size_t in_report(std::span<std::uint8_t>) noexcept override { return 0; }
  void power_cycle() noexcept override {}
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override { return nullptr; }
};

doctor::Facts facts_with_arm() {
  doctor::Controller controller;
  controller.node.path = "/dev/hidraw0";
  controller.node.is_there = true;
  controller.node.mode = 0666;
  doctor::Node raw;
  raw.path = "/dev/bus/usb/001/004";
  raw.is_there = true;
  raw.mode = 0666;
  raw.commanding_rights = 02;
  controller.raw_nodes = {raw};
  controller.address = "hid:A7";
  controller.serial_number = "A7";
  controller.usb_port = "1-4";
  controller.speed_mbit_per_s = "12";
  controller.holders = {{300, "steam", 1000, "ada"}};
  doctor::Facts facts;
  facts.controllers = {controller};
  return facts;
}

TEST(Inventory, ListsEverySimulatedModelAndWhatItNeeds) {
  const session::Plugins plugins;
  const std::vector<Entry> entries = simulated(plugins.models, plugins.drivers);

  ASSERT_THAT(entries, SizeIs(plugins.models.entries().size()));
  EXPECT_THAT(entries, testing::Contains(Field(&Entry::address, "sim:phantom-vintage")));
  EXPECT_THAT(entries, testing::Each(Field(&Entry::obstacle, "")));
  EXPECT_THAT(entries[0].needs, HasSubstr("amplifier_max_a is missing"));
  EXPECT_THAT(entries[0].description, testing::Not(""));
}

TEST(Inventory, SaysWhyAModelCannotBeMade) {
  session::Plugins plugins;
  plugins.models.add(
      {"broken", "",
       [](const plugin::SimModelSettings&) -> Result<std::unique_ptr<plugin::SimHidModel>> {
         return fail(Errc::System, "its data is damaged");
       }});
  EXPECT_EQ(simulated(plugins.models, plugins.drivers).back().obstacle, "its data is damaged");
}

TEST(Inventory, SaysThatNoDriverKnowsAModel) {
  session::Plugins plugins;
  plugins.models.add(
      {"stranger", "",
       [](const plugin::SimModelSettings&) -> Result<std::unique_ptr<plugin::SimHidModel>> {
         return std::make_unique<Stranger>();
       }});
  EXPECT_THAT(simulated(plugins.models, plugins.drivers).back().obstacle,
              HasSubstr("no driver knows it"));
}

TEST(Inventory, SaysWhyWhatIsPluggedInCannotBeUsed) {
  const std::vector<Entry> entries = plugged_in(facts_with_arm());

  ASSERT_THAT(entries, SizeIs(1));
  EXPECT_EQ(entries[0].address, "hid:A7");
  EXPECT_THAT(entries[0].obstacle,
              testing::AllOf(HasSubstr("every user may open /dev/hidraw0"),
                             HasSubstr("every user may write /dev/bus/usb/001/004"),
                             HasSubstr("'steam' (process 300 of user 'ada')"),
                             HasSubstr("thimble doctor")));
}

linux::FoundDevice found_arm() {
  linux::FoundDevice found;
  found.node = "/dev/hidraw0";
  found.info.address = {"hid:A7"};
  found.info.kind = bus::BusKind::Hid;
  found.info.vendor_id = 0x1234;
  found.info.product_id = 0x0006;
  found.info.manufacturer = "Maker";
  found.info.product = "Arm";
  found.info.input_report_bytes = found.info.output_report_bytes = 14;
  return found;
}

TEST(Inventory, SaysOfAnArmWhatAConfigurationMustSayAndWhatIsInTheWay) {
  const session::Plugins plugins;
  const std::vector<linux::FoundDevice> devices{found_arm()};
  const std::vector<Entry> entries = plugged_in(devices, facts_with_arm(), plugins.drivers);

  ASSERT_THAT(entries, SizeIs(1));
  EXPECT_EQ(entries[0].address, "hid:A7");
  EXPECT_EQ(entries[0].description, "Maker Arm, 1234:0006 at /dev/hidraw0");
  EXPECT_THAT(entries[0].needs, testing::AllOf(HasSubstr("before a person says that it is an arm"),
                                               HasSubstr("amplifier_max_a is missing")));
  EXPECT_THAT(entries[0].obstacle,
              testing::AllOf(HasSubstr("every user may open"), HasSubstr("'steam' (process 300")));
  EXPECT_THAT(entries[0].models, testing::IsSupersetOf({"phantom-vintage", "woody-2015"}));
  const doctor::Facts elsewhere;
  EXPECT_EQ(plugged_in(devices, elsewhere, plugins.drivers).at(0).obstacle, "");
}

TEST(Inventory, NamesTheOneModelOfADeviceThatTellsWhatItIs) {
  const session::Plugins plugins;
  std::vector<linux::FoundDevice> devices{found_arm()};
  devices[0].info = plugin::describe(*plugins.models.find("falcon")->create({}));
  EXPECT_THAT(plugged_in(devices, {}, plugins.drivers).at(0).models,
              testing::ElementsAre("falcon"));
}

TEST(Inventory, SaysThatAFalconWantsItsFirmware) {
  const session::Plugins plugins;
  std::vector<linux::FoundDevice> devices{found_arm()};
  devices[0].info = plugin::describe(*plugins.models.find("falcon")->create({}));
  EXPECT_THAT(plugged_in(devices, {}, plugins.drivers).at(0).needs,
              testing::StartsWith("arm.firmware: "));
}

NeededKeys keys_of_model(const char* name) {
  const session::Plugins plugins;
  std::vector<linux::FoundDevice> devices{found_arm()};
  devices[0].info = plugin::describe(*plugins.models.find(name)->create({}));
  return plugged_in(devices, {}, plugins.drivers).at(0).keys;
}

TEST(Inventory, KnowsWhichKeysAConfigurationHasToHave) {
  EXPECT_EQ(
      keys_of_model("phantom-vintage"),
      (NeededKeys{
          .model = true, .amplifier_max_a = true, .is_too_low_harmless = true, .limits = true}));
  EXPECT_EQ(keys_of_model("falcon"), (NeededKeys{.firmware = true, .limits = true}));
  EXPECT_EQ(keys_of_model("spacenavigator"), NeededKeys{});
}

TEST(Inventory, ListsWhatNoDriverKnows) {
  const session::Plugins plugins;
  std::vector<linux::FoundDevice> devices{found_arm(), found_arm()};
  devices[0].info.vendor_id = 0x046D;
  devices[1].info.input_report_bytes = 13;
  devices[1].info.manufacturer = devices[1].info.product = "";
  const std::vector<Entry> entries = plugged_in(devices, {}, plugins.drivers);

  ASSERT_THAT(entries, SizeIs(2));
  EXPECT_EQ(entries[0].obstacle, "no driver knows it");
  EXPECT_EQ(entries[1].obstacle,
            "no driver knows it: phantom: reports are neither 14 nor 64 bytes both ways");
  EXPECT_EQ(entries[1].description, "1234:0006 at /dev/hidraw0");
}

TEST(Inventory, MarksWhatTheDaemonUses) {
  std::vector<Entry> entries{{"sim:a", "", "", "", {}}, {"sim:b", "", "", "", {}}};
  api::Status status;
  status.arms.resize(3);
  status.arms[0].device = status.arms[1].device = "sim:b";
  status.arms[0].name = "left";
  status.arms[0].state = "active";
  status.arms[1].name = "right";
  status.arms[1].state = "fault";
  status.arms[2].device = "hid:gone";
  status.arms[2].state = "lost";

  mark_users(entries, status);

  ASSERT_THAT(entries, SizeIs(3));
  EXPECT_THAT(entries[0].users, SizeIs(0));
  EXPECT_THAT(entries[1].users, testing::ElementsAre("left (active)", "right (fault)"));
  EXPECT_EQ(entries[2].address, "hid:gone");
  EXPECT_EQ(entries[2].obstacle, "it is not there");
}

TEST(InventoryReport, BeginsWithThatNoArmIsPluggedInUnlessOneIs) {
  std::vector<Entry> entries{{"usb:1-4", "a camera", "no driver knows it", "", {}},
                             {"hid:gone", "", "it is not there", "", {"right (lost)"}},
                             {"sim:a", "an arm", "", "", {}}};
  EXPECT_THAT(render(entries, ""), testing::StartsWith("no arm is plugged in (thimble doctor)\n"));
  EXPECT_THAT(render({}, ""), testing::StartsWith("no arm is plugged in"));
  entries[0].is_plugged_in_arm = true;
  EXPECT_THAT(render(entries, ""), testing::StartsWith("usb:1-4  a camera\n"));
  EXPECT_TRUE(plugged_in(facts_with_arm()).at(0).is_plugged_in_arm);
}

TEST(InventoryReport, SaysOnceWhatSeveralNeed) {
  const std::vector<Entry> entries{{"sim:a", "", "", "its size, in full", {}},
                                   {"sim:b", "", "", "its size, in full", {}},
                                   {"sim:c", "", "", "its colour", {}}};
  const std::string text = render(entries, "");
  EXPECT_EQ(text.find("its size, in full"), text.rfind("its size, in full"));
  EXPECT_THAT(text,
              HasSubstr("sim:b\n    can be used; a configuration must say more, as for sim:a\n"));
  EXPECT_THAT(text, HasSubstr("must say more: its colour"));
}

TEST(InventoryReport, SaysOfEachWhetherItCanBeUsed) {
  const std::vector<Entry> entries{{"sim:a", "an arm", "", "", {"left (active)"}},
                                   {"sim:b", "another", "", "amplifier_max_a is missing", {}},
                                   {"hid:\x1b", "", std::string(90, 'x') + " y", "", {}}};
  const std::string text = render(entries, "no daemon");

  EXPECT_THAT(text, HasSubstr("sim:a  an arm\n    can be used\n    in use by left (active)\n"));
  EXPECT_THAT(text, HasSubstr("must say more: amplifier_max_a"));
  EXPECT_THAT(text, HasSubstr("hid:?\n    cannot be used:\n    xxx"));
  EXPECT_THAT(text, testing::EndsWith("no daemon\n"));
  const auto document = boost::json::parse(to_json(entries, "no daemon"));
  EXPECT_EQ(document.at("daemon").as_string(), "no daemon");
  const auto& devices = document.at("devices").as_array();
  ASSERT_EQ(devices.size(), 3U);
  EXPECT_TRUE(devices[0].at("usable").as_bool());
  EXPECT_EQ(devices[0].at("users").as_array().at(0).as_string(), "left (active)");
  EXPECT_FALSE(devices[2].at("usable").as_bool());
}

}  // namespace
}  // namespace thimble::devices_list
