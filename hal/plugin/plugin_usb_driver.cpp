#include "hal/plugin/plugin_usb_driver.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "hal/plugin/abi_text.hpp"
#include "hal/plugin/plugin_check.hpp"
#include "hal/plugin/plugin_refusal.hpp"
#include "hal/plugin/plugin_usb_device.hpp"

namespace thimble::plugin {
namespace {

thimble_usb_info info_for(const bus::BusDeviceInfo& info) {
  thimble_usb_info out{};
  out.struct_bytes = sizeof(out);
  out.vendor_id = info.vendor_id;
  out.product_id = info.product_id;
  const std::size_t count = std::min<std::size_t>(info.endpoints.size(), THIMBLE_USB_ENDPOINTS);
  out.endpoint_count = static_cast<std::uint32_t>(count);
  for (std::size_t i = 0; i < count; ++i) {
    const bus::UsbEndpointInfo& endpoint = info.endpoints[i];
    out.endpoints[i] = {endpoint.interface_number,
                        endpoint.address,
                        static_cast<std::uint8_t>(endpoint.kind),
                        0,
                        endpoint.max_packet_bytes,
                        0};
  }
  put_text(info.address.text, out.address);
  put_text(info.manufacturer, out.manufacturer);
  put_text(info.product, out.product);
  put_text(info.serial_number, out.serial_number);
  return out;
}

thimble_usb_settings settings_for(const DriverSettings& settings) {
  thimble_usb_settings out{};
  out.struct_bytes = sizeof(out);
  out.amplifier_max_a = settings.amplifier_max_a.value_or(0);
  out.newton_per_count = settings.newton_per_count.value_or(0);
  put_text(settings.model, out.model);
  put_text(settings.firmware, out.firmware);
  put_text(settings.firmware_sha256, out.sha256);
  return out;
}

bus::UsbClaim claim_of(const thimble_usb_driver& driver) {
  bus::UsbClaim claim;
  claim.interface_number = driver.claim.interface_number;
  for (std::size_t i = 0; i < driver.claim.pipe_count; ++i) {
    const thimble_usb_pipe& pipe = driver.claim.pipes[i];
    const bool is_queued = pipe.is_queued != 0 && bus::is_usb_in(pipe.endpoint);
    claim.pipes.push_back(
        {pipe.endpoint, is_queued ? bus::UsbDelivery::Every : bus::UsbDelivery::Newest});
  }
  return claim;
}

// Nothing for a packet that no pipe of the claim could send: such an arm cannot be guarded.
std::optional<ZeroCommand> zero_of(const thimble_usb_driver& driver, const thimble_usb_zero& said) {
  const thimble_usb_pipe* const end = driver.claim.pipes + driver.claim.pipe_count;
  const bool is_claimed = std::any_of(driver.claim.pipes, end, [&](const thimble_usb_pipe& pipe) {
    return pipe.endpoint == said.endpoint && !bus::is_usb_in(pipe.endpoint);
  });
  if (!is_claimed || said.size < 1 || said.size > sizeof(said.bytes)) return std::nullopt;
  ZeroCommand zero;
  zero.endpoint = said.endpoint;
  for (std::size_t i = 0; i < said.size; ++i) zero.bytes.push_back(said.bytes[i]);
  return zero;
}

class PluginUsbDriver final : public Driver {
 public:
  explicit PluginUsbDriver(const thimble_usb_driver& driver)
      : driver_(&driver), name_(text_of(driver.name)) {}

  [[nodiscard]] std::string_view name() const noexcept override { return name_; }
  [[nodiscard]] std::vector<std::string> models() const override { return {}; }
  // Which models it has only the plugin knows.
  [[nodiscard]] std::optional<std::vector<bus::BusKind>> buses_of(
      std::string_view /*model*/) const override {
    return std::vector{bus::BusKind::Usb};
  }
  [[nodiscard]] Result<void> check_files(
      const DriverSettings& /*a plugin cannot tell*/) const override {
    return {};
  }

  [[nodiscard]] Result<void> probe(const bus::BusDeviceInfo& info,
                                   const DriverSettings& settings) const override {
    if (info.kind != bus::BusKind::Usb) return fail(Errc::NotMine, {});
    thimble_reason reason{};
    const thimble_usb_info about = info_for(info);
    const thimble_usb_settings said = settings_for(settings);
    const auto matched = check_match(driver_->match(&about, &said, &reason), reason);
    return matched ? check_named(info, settings) : matched;
  }

  [[nodiscard]] Result<std::unique_ptr<HapticDevice>> open(
      bus::BusEnumerator& buses, const bus::BusDeviceInfo& info,
      const DriverSettings& settings) const override {
    const auto mine = probe(info, settings);
    if (!mine) return tl::unexpected(mine.error());
    auto usb = buses.open_usb(info.address, claim_of(*driver_));
    if (!usb) return tl::unexpected(usb.error());
    auto pipes = std::make_unique<PluginUsbBus>(*std::move(usb));
    thimble_capabilities said{};
    said.struct_bytes = sizeof(said);
    thimble_usb_zero zero{};
    zero.struct_bytes = sizeof(zero);
    void* device = nullptr;
    thimble_reason reason{};
    const thimble_usb_info about = info_for(info);
    const thimble_usb_settings wanted = settings_for(settings);
    const std::int32_t status =
        driver_->open(&about, &wanted, &pipes->table(), &said, &zero, &device, &reason);
    if (const auto opened = check_opened(status, device, reason); !opened) {
      return tl::unexpected(opened.error());
    }
    auto capabilities = read_capabilities(said);
    if (!capabilities) {
      driver_->close(device);
      return tl::unexpected(capabilities.error().in("the plugin"));
    }
    return std::make_unique<PluginUsbDevice>(PluginUsbDevice::Parts{
        driver_, device, std::move(pipes), *std::move(capabilities), zero_of(*driver_, zero)});
  }

 private:
  const thimble_usb_driver* driver_;
  std::string name_;
};

}  // namespace

std::unique_ptr<Driver> make_plugin_usb_driver(const thimble_usb_driver& driver) {
  return std::make_unique<PluginUsbDriver>(driver);
}

}  // namespace thimble::plugin
