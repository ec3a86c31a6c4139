#include <gtest/gtest.h>

#include <string>

#include "hal/bus/hid_report_descriptor.hpp"
#include "hal/bus/usb_descriptor.hpp"
#include "sim/export/hid_on_usb.hpp"
#include "sim/export/usb_descriptors.hpp"
#include "sim/model/arm/register_arm_models.hpp"
#include "sim/model/spacemouse/register_spacemouse_models.hpp"

namespace thimble::sim {
namespace {

class EveryHidModel : public ::testing::Test {
 protected:
  EveryHidModel() {
    register_arm_models(models_);
    register_spacemouse_models(models_);
  }
  plugin::SimModelRegistry models_;
};

TEST_F(EveryHidModel, HasADescriptorThatSaysTheLengthsOfItsReports) {
  for (const plugin::SimModelEntry& entry : models_.entries()) {
    const auto model = *entry.create_hid({});
    const bus::BusDeviceInfo info = model->describe();
    const std::vector<std::uint8_t> bytes = model->report_descriptor();
    EXPECT_EQ(bus::parse_report_descriptor(std::string(bytes.begin(), bytes.end())),
              (bus::HidReportLengths{info.input_report_bytes, info.output_report_bytes,
                                     info.has_report_ids}))
        << entry.name;
  }
}

TEST_F(EveryHidModel, IsAskedOverUsbAsOftenAsItHasSomethingToSay) {
  for (const plugin::SimModelEntry& entry : models_.entries()) {
    const auto model = *entry.create_hid({});
    const HidOnUsb wrapped(*model);
    const bus::BusDeviceInfo info = wrapped.describe();
    ASSERT_FALSE(info.endpoints.empty());
    EXPECT_EQ(info.endpoints[0].interval * std::chrono::milliseconds(1), model->frame_period())
        << entry.name;
  }
}

}  // namespace
}  // namespace thimble::sim
