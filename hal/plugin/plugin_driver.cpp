#include "hal/plugin/plugin_driver.hpp"

#include <algorithm>
#include <string>

#include "hal/plugin/abi_text.hpp"
#include "hal/plugin/plugin_check.hpp"
#include "hal/plugin/plugin_device.hpp"
#include "hal/plugin/plugin_refusal.hpp"

namespace thimble::plugin {
namespace {

thimble_hid_info info_for(const bus::BusDeviceInfo& info) {
  thimble_hid_info out{};
  out.struct_bytes = sizeof(out);
  out.vendor_id = info.vendor_id;
  out.product_id = info.product_id;
  out.input_report_bytes = static_cast<std::uint32_t>(info.input_report_bytes);
  out.output_report_bytes = static_cast<std::uint32_t>(info.output_report_bytes);
  put_text(info.address.text, out.address);
  put_text(info.manufacturer, out.manufacturer);
  put_text(info.product, out.product);
  put_text(info.serial_number, out.serial_number);
  return out;
}

thimble_driver_settings settings_for(const DriverSettings& settings) {
  thimble_driver_settings out{};
  out.struct_bytes = sizeof(out);
  out.amplifier_max_a = settings.amplifier_max_a.value_or(0);
  put_text(settings.model, out.model);
  return out;
}

// When the daemon dies with the plugin that it runs, nothing but the arm itself ends the force.
Result<HapticCapabilities> stoppable_on(const bus::BusDeviceInfo& info, HapticCapabilities arm) {
  if (arm.device_watchdog > Duration::zero() || bus::is_simulated(info.address.text)) return arm;
  return fail(Errc::Unsupported,
              "has an arm without a watchdog: it would keep its last force when the daemon ends");
}

class PluginDriver final : public Driver {
 public:
  explicit PluginDriver(const thimble_driver& driver)
      : driver_(&driver), name_(text_of(driver.name)) {}

  [[nodiscard]] std::string_view name() const noexcept override { return name_; }
  [[nodiscard]] std::vector<std::string> models() const override { return {}; }
  // Which models it has only the plugin knows.
  [[nodiscard]] std::optional<std::vector<bus::BusKind>> buses_of(
      std::string_view /*model*/) const override {
    return std::vector{bus::BusKind::Hid};
  }
  [[nodiscard]] Result<void> check_files(
      const DriverSettings& /*a plugin cannot tell*/) const override {
    return {};
  }

  [[nodiscard]] Result<void> probe(const bus::BusDeviceInfo& info,
                                   const DriverSettings& settings) const override {
    if (info.kind != bus::BusKind::Hid ||
        !check_report_bytes(info.input_report_bytes, info.output_report_bytes)) {
      return fail(Errc::NotMine, {});
    }
    thimble_reason reason{};
    const thimble_hid_info hid = info_for(info);
    const thimble_driver_settings said = settings_for(settings);
    const auto matched = check_match(driver_->match(&hid, &said, &reason), reason);
    return matched ? check_named(info, settings) : matched;
  }

  [[nodiscard]] Result<std::unique_ptr<HapticDevice>> open(
      bus::BusEnumerator& buses, const bus::BusDeviceInfo& info,
      const DriverSettings& settings) const override {
    const auto mine = probe(info, settings);
    if (!mine) return tl::unexpected(mine.error());
    auto hid = buses.open_hid(info.address);
    if (!hid) return tl::unexpected(hid.error());
    thimble_capabilities said{};
    said.struct_bytes = sizeof(said);
    void* device = nullptr;
    thimble_reason reason{};
    const thimble_hid_info about = info_for(info);
    const thimble_driver_settings wanted = settings_for(settings);
    const std::int32_t status = driver_->open(&about, &wanted, &said, &device, &reason);
    if (const auto opened = check_opened(status, device, reason); !opened) {
      return tl::unexpected(opened.error());
    }
    auto capabilities = read_capabilities(said);
    if (capabilities) capabilities = stoppable_on(info, *std::move(capabilities));
    if (!capabilities) {
      driver_->close(device);
      return tl::unexpected(capabilities.error().in("the plugin"));
    }
    return std::make_unique<PluginDevice>(
        PluginDevice::Parts{driver_, device, *std::move(hid), info.output_report_bytes},
        *std::move(capabilities), text_of(said.calibration_instruction));
  }

 private:
  const thimble_driver* driver_;
  std::string name_;
};

}  // namespace

std::unique_ptr<Driver> make_plugin_driver(const thimble_driver& driver) {
  return std::make_unique<PluginDriver>(driver);
}

}  // namespace thimble::plugin
