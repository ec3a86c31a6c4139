#include "drivers/spacemouse/spacemouse_driver.hpp"

#include <algorithm>
#include <string>
#include <string_view>

#include "drivers/spacemouse/find_model.hpp"
#include "drivers/spacemouse/spacemouse_device.hpp"
#include "drivers/spacemouse/spacemouse_wire.hpp"

namespace thimble::spacemouse {
namespace {

// The simulated one's name, and as arm.model that of any puck.
constexpr std::string_view kAnyPuck = "spacemouse";

Result<const SpaceMouseModel*> match(const bus::BusDeviceInfo& info,
                                     const plugin::DriverSettings& settings) {
  const SpaceMouseModel* model = find_model(info.vendor_id, info.product_id);
  if (info.kind != bus::BusKind::Hid || model == nullptr) {
    return fail(Errc::NotMine, {});
  }
  // A receiver has more faces than one, such as a keyboard's.
  if (!info.has_report_ids || info.input_report_bytes < wire::kSeparateBytes) {
    return fail(Errc::NotMine, "has no reports of axes");
  }
  const std::string& said = settings.model;
  if (!said.empty() && said != model->name && said != kAnyPuck) {
    return fail(Errc::InvalidArgument, "it is a '" + std::string(model->name) +
                                           "', but the configuration says that the model is '" +
                                           said + "'");
  }
  return model;
}

class SpaceMouseDriver final : public plugin::Driver {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "spacemouse"; }
  [[nodiscard]] std::vector<std::string> models() const override {
    std::vector<std::string> names{std::string(kAnyPuck)};
    for (const SpaceMouseModel& model : kSpaceMouseModels) names.emplace_back(model.name);
    return names;
  }
  [[nodiscard]] std::optional<std::vector<bus::BusKind>> buses_of(
      std::string_view model) const override {
    const std::vector<std::string> mine = models();
    const bool is_mine = model.empty() || std::find(mine.begin(), mine.end(), model) != mine.end();
    return is_mine ? std::vector{bus::BusKind::Hid} : std::vector<bus::BusKind>{};
  }
  [[nodiscard]] std::optional<plugin::UsedSettings> used_settings() const override {
    return plugin::UsedSettings{};
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
    if (settings.clock == nullptr) {
      return fail(Errc::InvalidArgument,
                  "a puck at rest says nothing, so its driver needs a clock");
    }
    auto hid = buses.open_hid(info.address);
    if (!hid) return tl::unexpected<Error>(hid.error().in("spacemouse"));
    return std::make_unique<SpaceMouseDevice>(std::move(*hid), **found, *settings.clock);
  }
};

}  // namespace

std::unique_ptr<plugin::Driver> make_spacemouse_driver() {
  return std::make_unique<SpaceMouseDriver>();
}

}  // namespace thimble::spacemouse
