#include "hal/plugin/plugin_refusal.hpp"

#include <string>

#include "hal/plugin/abi_text.hpp"

namespace thimble::plugin {

tl::unexpected<Error> refusal_of(const thimble_reason& reason) {
  const std::string text = text_of(reason.text);
  return fail(Errc::InvalidArgument,
              text.empty() ? "the plugin refuses it and does not say why" : text);
}

Result<void> check_named(const bus::BusDeviceInfo& info, const DriverSettings& settings) {
  if (settings.is_named_by_person || bus::is_simulated(info.address.text)) return {};
  return fail(Errc::Permission,
              "a plugin's device must be named by the configuration: set "
              "the arm's device to \"" +
                  info.address.text + "\"");
}

}  // namespace thimble::plugin
