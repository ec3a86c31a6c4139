#include "hal/plugin/sim_model.hpp"

#include <gtest/gtest.h>

#include "sim/bus/sim_enumerator.hpp"
#include "tests/support/scripted_hid_model.hpp"
#include "tests/support/scripted_serial_model.hpp"
#include "tests/support/scripted_usb_model.hpp"

namespace thimble::sim {
namespace {

plugin::SimModelEntry hid_entry() {
  plugin::SimModelEntry entry{"scripted", "on the HID bus"};
  entry.create_hid = [](const plugin::SimModelSettings&) {
    return std::make_unique<test::ScriptedHidModel>(std::make_shared<test::HidModelScript>());
  };
  return entry;
}

plugin::SimModelEntry usb_entry() {
  plugin::SimModelEntry entry{"scripted", "on bare USB"};
  entry.create_usb = [](const plugin::SimModelSettings&) {
    return std::make_unique<test::ScriptedUsbModel>(std::make_shared<test::UsbModelScript>());
  };
  return entry;
}

plugin::SimModelEntry serial_entry() {
  plugin::SimModelEntry entry{"scripted", "at the end of a line"};
  entry.create_serial = [](const plugin::SimModelSettings&) {
    return std::make_unique<test::ScriptedSerialModel>(std::make_shared<test::SerialModelScript>());
  };
  return entry;
}

class SimModelTest : public testing::Test {
 protected:
  bus::BusDeviceInfo plugged(const plugin::SimModelEntry& entry) {
    Result<plugin::SimModel> made = entry.create({});
    EXPECT_TRUE(made);
    EXPECT_EQ(plugin::arm_backend(*made), nullptr);
    bus::BusDeviceInfo said = plugin::describe(*made);
    said.address = address;
    EXPECT_TRUE(buses.plug_any(address, *std::move(made)));
    EXPECT_EQ(buses.list().at(0), said);
    return said;
  }

  bus::DeviceAddress address{"sim:scripted"};
  VirtualClock clock;
  SimEnumerator buses{clock};
};

TEST_F(SimModelTest, OneOfHidIsPluggedIntoThatBus) {
  EXPECT_EQ(plugged(hid_entry()).kind, bus::BusKind::Hid);
  EXPECT_TRUE(buses.open_hid(address));
  EXPECT_FALSE(buses.open_usb(address, {}));
}

TEST_F(SimModelTest, OneOfALineIsPluggedIntoThatBus) {
  EXPECT_EQ(plugged(serial_entry()).kind, bus::BusKind::Serial);
  EXPECT_TRUE(buses.open_serial(address, {}));
  EXPECT_FALSE(buses.open_hid(address));
  EXPECT_FALSE(buses.open_usb(address, {}));
}

TEST_F(SimModelTest, OneOfUsbIsPluggedIntoThatBus) {
  // Its describe() says nothing of its bus: the creator does.
  EXPECT_EQ(plugged(usb_entry()).kind, bus::BusKind::Usb);
  bus::UsbClaim claim;
  claim.pipes.push_back({test::ScriptedUsbModel::kBulkIn, bus::UsbDelivery::Every});
  EXPECT_TRUE(buses.open_usb(address, claim));
  EXPECT_FALSE(buses.open_hid(address));
}

TEST_F(SimModelTest, OneThatMakesNothingSaysSo) {
  plugin::SimModelEntry none{"none", ""};
  EXPECT_EQ(none.create({}).error().code, Errc::InvalidArgument);
  none.create_hid = [](const plugin::SimModelSettings&) {
    return Result<std::unique_ptr<plugin::SimHidModel>>(nullptr);
  };
  EXPECT_EQ(none.create({}).error().code, Errc::InvalidArgument);
  none.create_usb =
      [](const plugin::SimModelSettings&) -> Result<std::unique_ptr<plugin::SimUsbModel>> {
    return fail(Errc::System, "no data");
  };
  EXPECT_EQ(none.create({}).error(), (Error{Errc::System, "no data"}));
}

}  // namespace
}  // namespace thimble::sim
