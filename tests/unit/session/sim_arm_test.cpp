#include "daemon/session/sim_arm.hpp"

#include <gtest/gtest.h>

#include "tests/support/scripted_usb_model.hpp"

namespace thimble::session {
namespace {

// An arm on bare USB whose tip nobody moves.
class UsbArm final : public plugin::SimUsbModel, public plugin::ArmBackend {
 public:
  bus::BusDeviceInfo describe() const override { return inner_.describe(); }
  void advance(MonotonicTime) noexcept override {}
  plugin::UsbAnswer control(const bus::UsbControlRequest&,
                            std::span<std::uint8_t>) noexcept override {
    return {};
  }
  plugin::UsbHandshake out_packet(std::uint8_t, std::span<const std::uint8_t>) noexcept override {
    return plugin::UsbHandshake::Nak;
  }
  plugin::UsbAnswer in_packet(std::uint8_t, std::span<std::uint8_t>) noexcept override {
    return {};
  }
  void power_cycle() noexcept override {}
  plugin::ArmBackend* arm_backend() noexcept override { return this; }
  void hold_tip(plugin::TipLoad*) noexcept override {}
  void push_tip(Force3) noexcept override {}
  bool move_tip_to(Position3) noexcept override { return false; }
  void press_calibration_button(bool) noexcept override {}
  void press_stylus_button(bool) noexcept override {}
  void turn_stylus(const std::array<double, 3>&) noexcept override {}
  Position3 home_position() const noexcept override { return {0, 0, 0.5}; }
  plugin::ArmTruth truth() const noexcept override { return {}; }

 private:
  test::ScriptedUsbModel inner_{std::make_shared<test::UsbModelScript>()};
};

class SimArmTest : public testing::Test {
 protected:
  SimArmTest() { arm.device = "sim:some"; }
  template <class Model>
  void offer(Model (*make)()) {
    plugin::SimModelEntry entry{"some", ""};
    entry.create_usb = [make](const plugin::SimModelSettings&) { return make(); };
    models.add(std::move(entry));
  }
  plugin::SimModelRegistry models;
  config::ArmConfig arm;
};

TEST_F(SimArmTest, PlugsAnArmIntoTheBusThatItsModelIsOn) {
  offer(+[] { return std::make_unique<UsbArm>(); });
  const auto sut = SimArm::create(models, arm);
  ASSERT_TRUE(sut) << sut.error().message;
  EXPECT_EQ((*sut)->backend().home_position(), (Position3{0, 0, 0.5}));
  const bus::BusDeviceInfo info = (*sut)->buses().list().at(0);
  EXPECT_EQ(info.address.text, "sim:some");
  EXPECT_EQ(info.kind, bus::BusKind::Usb);
}

TEST_F(SimArmTest, RefusesWhatIsNoArm) {
  offer(+[] {
    return std::make_unique<test::ScriptedUsbModel>(std::make_shared<test::UsbModelScript>());
  });
  const auto sut = SimArm::create(models, arm);
  ASSERT_FALSE(sut);
  EXPECT_EQ(sut.error().code, Errc::InvalidArgument);
}

}  // namespace
}  // namespace thimble::session
