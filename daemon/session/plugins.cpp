#include "daemon/session/plugins.hpp"

#include "drivers/falcon/falcon_driver.hpp"
#include "drivers/phantom/phantom_driver.hpp"
#include "drivers/spacemouse/spacemouse_driver.hpp"
#include "hal/plugin/plugin_loader.hpp"
#include "sim/model/arm/register_arm_models.hpp"
#include "sim/model/arm/text_arm_model.hpp"
#include "sim/model/falcon/register_falcon_model.hpp"
#include "sim/model/spacemouse/register_spacemouse_models.hpp"

namespace thimble::session {

Plugins::Plugins() {
  drivers.add(phantom::make_phantom_driver());
  drivers.add(falcon::make_falcon_driver());
  drivers.add(spacemouse::make_spacemouse_driver());
  sim::register_arm_models(models);
  sim::register_text_arm_models(models);
  sim::register_falcon_model(models);
  sim::register_spacemouse_models(models);
}

std::vector<Error> Plugins::load(const std::vector<std::string>& paths) {
  std::vector<Error> refused;
  for (const std::string& path : paths) {
    const Result<const thimble_plugin*> plugin = plugin::load_plugin(path);
    if (!plugin) {
      refused.push_back(plugin.error());
      continue;
    }
    const Result<void> added = plugin::register_plugin(**plugin, drivers, models);
    if (!added) refused.push_back(added.error().in(path));
  }
  return refused;
}

}  // namespace thimble::session
