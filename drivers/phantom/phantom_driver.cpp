#include "drivers/phantom/phantom_driver.hpp"

#include "drivers/phantom/phantom_device.hpp"
#include "drivers/phantom/phantom_match.hpp"

namespace thimble::phantom {
namespace {

class PhantomDriver final : public plugin::Driver {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "phantom"; }

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
    auto hid = buses.open_hid(info.address);
    if (!hid) return tl::unexpected<Error>(hid.error().in("phantom"));
    return std::make_unique<PhantomDevice>(std::move(*hid), *found->model, found->settings);
  }
};

}  // namespace

std::unique_ptr<plugin::Driver> make_phantom_driver() { return std::make_unique<PhantomDriver>(); }

}  // namespace thimble::phantom
