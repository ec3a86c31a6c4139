#include "hal/plugin/sim_model.hpp"

#include "hal/bus/hid_report_descriptor.hpp"

namespace thimble::plugin {
namespace {

// Asks one of the creators, where there is that one.
template <class Model>
Result<SimModel> ask(
    const std::function<Result<std::unique_ptr<Model>>(const SimModelSettings&)>& create,
    const SimModelSettings& settings) {
  Result<std::unique_ptr<Model>> made = create ? create(settings) : nullptr;
  if (!made) return tl::unexpected(made.error());
  if (*made == nullptr) return fail(Errc::InvalidArgument, "the model makes no device");
  return SimModel(*std::move(made));
}

}  // namespace

std::vector<std::uint8_t> SimHidModel::report_descriptor() const {
  const bus::BusDeviceInfo info = describe();
  return bus::plain_report_descriptor({info.input_report_bytes, info.output_report_bytes});
}

Result<SimModel> SimModelEntry::create(const SimModelSettings& settings) const {
  if (create_serial) return ask(create_serial, settings);
  return create_usb ? ask(create_usb, settings) : ask(create_hid, settings);
}

bus::BusDeviceInfo describe(const SimModel& model) {
  bus::BusDeviceInfo info =
      std::visit([](const auto& device) { return device->describe(); }, model);
  info.kind = bus::BusKind::Usb;
  if (std::holds_alternative<std::unique_ptr<SimHidModel>>(model)) info.kind = bus::BusKind::Hid;
  if (std::holds_alternative<std::unique_ptr<SimSerialModel>>(model)) {
    info.kind = bus::BusKind::Serial;
  }
  return info;
}

ArmBackend* arm_backend(const SimModel& model) noexcept {
  // Not std::visit: that may throw.
  if (const auto* hid = std::get_if<std::unique_ptr<SimHidModel>>(&model)) {
    return (*hid)->arm_backend();
  }
  if (const auto* serial = std::get_if<std::unique_ptr<SimSerialModel>>(&model)) {
    return (*serial)->arm_backend();
  }
  const auto* usb = std::get_if<std::unique_ptr<SimUsbModel>>(&model);
  return usb == nullptr ? nullptr : (*usb)->arm_backend();
}

}  // namespace thimble::plugin
