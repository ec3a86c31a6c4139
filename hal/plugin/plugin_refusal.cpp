#include "hal/plugin/plugin_refusal.hpp"

#include <string>

#include "hal/plugin/abi_text.hpp"

namespace thimble::plugin {
namespace {

tl::unexpected<Error> refusal_of(const thimble_reason& reason) {
  const std::string text = text_of(reason.text);
  return fail(Errc::InvalidArgument,
              text.empty() ? "the plugin refuses it and does not say why" : text);
}

}  // namespace

Result<void> check_match(std::int32_t status, const thimble_reason& reason) {
  if (status == THIMBLE_NOT_MINE) return fail(Errc::NotMine, {});
  if (status != THIMBLE_OK) return refusal_of(reason);
  return {};
}

Result<void> check_opened(std::int32_t status, const void* device, const thimble_reason& reason) {
  if (status != THIMBLE_OK) return refusal_of(reason);
  if (device == nullptr) return fail(Errc::Malformed, "the plugin opened it and gave no device");
  return {};
}

Result<void> check_named(const bus::BusDeviceInfo& info, const DriverSettings& settings) {
  if (settings.is_named_by_person || bus::is_simulated(info.address.text)) return {};
  return fail(Errc::Permission,
              "a plugin's device must be named by the configuration: set "
              "the arm's device to \"" +
                  info.address.text + "\"");
}

}  // namespace thimble::plugin
