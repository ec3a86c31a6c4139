#include "drivers/falcon/falcon_driver.hpp"

#include <cstdint>
#include <vector>

#include "drivers/falcon/falcon_device.hpp"
#include "drivers/falcon/falcon_match.hpp"
#include "drivers/falcon/find_model.hpp"
#include "drivers/falcon/firmware_image.hpp"

namespace thimble::falcon {
namespace {

Result<std::vector<std::uint8_t>> image_for(const plugin::DriverSettings& settings) {
  if (settings.firmware.empty()) return std::vector<std::uint8_t>{};
  return load_image(settings.firmware, settings.firmware_sha256);
}

class FalconDriver final : public plugin::Driver {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "falcon"; }
  [[nodiscard]] std::vector<std::string> models() const override {
    std::vector<std::string> names;
    names.reserve(kFalconModels.size());
    for (const FalconModel& model : kFalconModels) names.emplace_back(model.name);
    return names;
  }
  [[nodiscard]] std::optional<std::vector<bus::BusKind>> buses_of(
      std::string_view model) const override {
    const bool is_mine = model.empty() || find_model(model) != nullptr;
    return is_mine ? std::vector{bus::BusKind::Usb} : std::vector<bus::BusKind>{};
  }
  [[nodiscard]] std::optional<plugin::UsedSettings> used_settings() const override {
    return plugin::UsedSettings{.firmware = true, .newton_per_count = true};
  }
  [[nodiscard]] Result<void> check_files(const plugin::DriverSettings& settings) const override {
    const auto image = image_for(settings);
    if (!image) return tl::unexpected<Error>(image.error());
    return {};
  }

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
    auto image = image_for(settings);
    if (!image) return tl::unexpected<Error>(image.error().in("falcon"));
    auto usb = buses.open_usb(info.address, claim());
    if (!usb) return tl::unexpected<Error>(usb.error().in("falcon"));
    return std::make_unique<FalconDevice>(
        std::move(*usb), *found->model,
        FalconDevice::Settings{found->newton_per_count, std::move(*image), settings.clock});
  }
};

}  // namespace

std::unique_ptr<plugin::Driver> make_falcon_driver() { return std::make_unique<FalconDriver>(); }

}  // namespace thimble::falcon
