#include "drivers/falcon/falcon_driver.hpp"

#include "drivers/falcon/falcon_device.hpp"
#include "drivers/falcon/falcon_match.hpp"
#include "drivers/falcon/firmware_image.hpp"

namespace thimble::falcon {
namespace {

class FalconDriver final : public plugin::Driver {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "falcon"; }

  [[nodiscard]] Result<void> probe(const bus::BusDeviceInfo& info,
                                   const plugin::DriverSettings& settings) const override {
    const auto found = match(info, settings);
    if (!found) return tl::unexpected<Error>(found.error());
    return {};
  }

  [[nodiscard]] Result<std::unique_ptr<HapticDevice>> open(
      bus::BusEnumerator& buses, const bus::BusDeviceInfo& info,
      const plugin::DriverSettings& settings) const override {
    const auto found = match(info, settings);
    if (!found) return tl::unexpected<Error>(found.error());
    FalconDevice::Settings device_settings{.newton_per_count = found->newton_per_count,
                                           .image = {}};
    if (!settings.firmware.empty()) {
      auto image = load_image(settings.firmware, settings.firmware_sha256);
      if (!image) return tl::unexpected<Error>(image.error().in("falcon"));
      device_settings.image = std::move(*image);
    }
    auto usb = buses.open_usb(info.address, claim());
    if (!usb) return tl::unexpected<Error>(usb.error().in("falcon"));
    return std::make_unique<FalconDevice>(std::move(*usb), *found->model,
                                          std::move(device_settings));
  }
};

}  // namespace

std::unique_ptr<plugin::Driver> make_falcon_driver() { return std::make_unique<FalconDriver>(); }

}  // namespace thimble::falcon
