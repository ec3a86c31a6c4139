#include "drivers/phantom/phantom_driver.hpp"

#include "drivers/phantom/find_model.hpp"
#include "drivers/phantom/hid_link.hpp"
#include "drivers/phantom/phantom_device.hpp"
#include "drivers/phantom/phantom_match.hpp"
#include "drivers/phantom/text_link.hpp"
#include "drivers/phantom/text_wire.hpp"

namespace thimble::phantom {
namespace {

using Link = std::unique_ptr<ControllerLink>;

Result<Link> open_hid(bus::BusEnumerator& buses, const bus::DeviceAddress& address,
                      ReportForm form) {
  auto hid = buses.open_hid(address);
  if (!hid) return tl::unexpected<Error>(hid.error().in("phantom"));
  return std::make_unique<HidLink>(std::move(*hid), form);
}

// Its rate is that of the upstream host; the device takes no notice.
Result<Link> open_text(bus::BusEnumerator& buses, const bus::DeviceAddress& address,
                       const Match& found, const Clock* clock) {
  if (clock == nullptr) return fail(Errc::InvalidArgument, "phantom: no clock was given");
  auto port = buses.open_serial(address, {});
  if (!port) return tl::unexpected<Error>(port.error().in("phantom"));
  return std::make_unique<TextLink>(std::move(*port), *found.model, found.amplifier_max_a, *clock);
}

class PhantomDriver final : public plugin::Driver {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "phantom"; }
  [[nodiscard]] std::vector<std::string> models() const override {
    std::vector<std::string> names;
    names.reserve(kPhantomModels.size());
    for (const PhantomModel& model : kPhantomModels) names.emplace_back(model.name);
    return names;
  }
  [[nodiscard]] std::optional<std::vector<bus::BusKind>> buses_of(
      std::string_view model) const override {
    if (model.empty()) return std::vector{bus::BusKind::Hid, bus::BusKind::Serial};
    if (find_model(model) == nullptr) return std::vector<bus::BusKind>{};
    // The text protocol is that of some arms' firmware only.
    if (!text::build_number(model)) return std::vector{bus::BusKind::Hid};
    return std::vector{bus::BusKind::Hid, bus::BusKind::Serial};
  }
  [[nodiscard]] std::optional<plugin::UsedSettings> used_settings() const override {
    return plugin::UsedSettings{.amplifier_max_a = true};
  }
  [[nodiscard]] Result<void> check_files(
      const plugin::DriverSettings& /*it reads none*/) const override {
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
    Result<Link> link = found->form ? open_hid(buses, info.address, *found->form)
                                    : open_text(buses, info.address, *found, settings.clock);
    if (!link) return tl::unexpected<Error>(link.error());
    return std::make_unique<PhantomDevice>(std::move(*link), *found->model, found->amplifier_max_a);
  }
};

}  // namespace

std::unique_ptr<plugin::Driver> make_phantom_driver() { return std::make_unique<PhantomDriver>(); }

}  // namespace thimble::phantom
