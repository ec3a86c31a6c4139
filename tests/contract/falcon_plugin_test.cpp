#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "drivers/falcon/firmware_image.hpp"
#include "hal/plugin/plugin_loader.hpp"
#include "tests/support/closed_loop.hpp"
#include "tests/support/falcon_image.hpp"
#include "tests/support/private_copy.hpp"

// The Falcon's driver twice, built in and as a shared object: one session, the same to the bit.
namespace thimble {
namespace {

struct Moment {
  OperatingState state{};
  CalibrationState calibration{};
  FaultCode fault{};
  IoStatus read{};
  IoStatus write{};
  std::uint32_t buttons{0};
  Duration age{};
  Position3 tip{};
  Force3 force{};
  Force3 motor_force{};  // what reached the motors
  std::string instruction;
  bool operator==(const Moment&) const = default;
};

class FalconPlugin : public testing::Test {
 protected:
  // A whole life: boot, upload, homing, the box, the cable pulled and put back, a clear, and all
  // again.
  std::vector<Moment> live(bool is_plugin, const std::string& device) {
    test::ClosedLoop::Setup setup;
    const std::vector<std::uint8_t> image = test::falcon_image();
    const auto file =
        folder_.write("image", {reinterpret_cast<const char*>(image.data()), image.size()});
    std::vector<std::string> overrides{"arm.0.device=" + device, "arm.0.firmware=" + file.string(),
                                       "arm.0.firmware_sha256=" + falcon::sha256_of(image),
                                       "arm.0.newton_per_count=0.0025"};
    if (is_plugin) overrides.push_back("daemon.plugins=['" + plugin_ + "']");
    test::ClosedLoop sut(overrides, setup);
    std::vector<Moment> life;
    const auto note = [&] {
      const servo::ServoFrame& frame = sut.frame();
      life.push_back({frame.state, frame.calibration, frame.fault, frame.read_status,
                      frame.write_status, frame.buttons, frame.sample_age, frame.tip, frame.force,
                      sut.truth().motor_force, sut.instruction()});
    };
    sut.run(20, note);
    contacts_ = sut.snapshot().total_contacts;
    sut.unplug();
    sut.run(0.2, note);
    sut.replug();
    sut.run(10, note);
    EXPECT_EQ(sut.frame().state, OperatingState::Fault);
    sut.controls().request_clear(sut.snapshot().fault.number);
    sut.run(10, note);
    EXPECT_EQ(sut.arm().session().device().counters().malformed, 0U);
    return life;
  }
  testing_support::TemporaryFolder folder_;
  std::string plugin_ = testing_support::private_copy(folder_, THIMBLE_FALCON_PLUGIN);
  std::uint64_t contacts_{0};
};

TEST_F(FalconPlugin, LivesTheSameLifeAsTheDriverThatIsBuiltIn) {
  for (const std::string device : {"sim:falcon", "sim:falcon-loaded"}) {
    const std::vector<Moment> built_in = live(false, device);
    EXPECT_GT(contacts_, 0U);
    const std::vector<Moment> plugin = live(true, device);
    ASSERT_EQ(built_in.size(), plugin.size());
    for (std::size_t i = 0; i < built_in.size(); ++i) {
      ASSERT_EQ(built_in[i], plugin[i])
          << device << " tick " << i << ": " << to_string(built_in[i].state) << ", "
          << to_string(plugin[i].state);
    }
    EXPECT_EQ(plugin.back().state, OperatingState::Active);
  }
}

TEST_F(FalconPlugin, RefusesInTheWordsOfTheDriverThatIsBuiltIn) {
  session::Plugins plugins;
  plugins.drivers = {};
  ASSERT_TRUE(plugins.load({plugin_}).empty());
  bus::BusDeviceInfo info;
  info.address = {"sim:falcon"};
  info.kind = bus::BusKind::Usb;
  info.vendor_id = 0x0403;
  info.product_id = 0xcb48;
  const plugin::Driver& sut = *plugins.drivers.drivers().front();
  EXPECT_EQ(sut.probe(info, {}).error().code, Errc::NotMine) << "without its pipes";
  info.endpoints = {{0, 0x81, bus::UsbTransferKind::Bulk, 64, 0},
                    {0, 0x02, bus::UsbTransferKind::Bulk, 64, 0}};
  EXPECT_TRUE(sut.probe(info, {}));
  plugin::DriverSettings settings;
  settings.newton_per_count = 1e-9;
  const auto refused = sut.probe(info, settings);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("newton_per_count"), std::string::npos);
  info.address = {"usb:port-1-2"};
  EXPECT_EQ(sut.probe(info, {}).error().code, Errc::Permission) << "not named by a person";
}

TEST_F(FalconPlugin, StandsInThePlaceOfTheDriverThatIsBuiltIn) {
  session::Plugins plugins;
  const std::size_t drivers = plugins.drivers.drivers().size();
  ASSERT_TRUE(plugins.load({plugin_}).empty());
  EXPECT_EQ(plugins.drivers.drivers().size(), drivers);
  EXPECT_TRUE(plugins.drivers.is_from_outside("falcon"));
}

}  // namespace
}  // namespace thimble
