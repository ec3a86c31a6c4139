#include "daemon/session/plugins.hpp"

#include "drivers/phantom/phantom_driver.hpp"
#include "sim/model/arm/register_arm_models.hpp"

namespace thimble::session {

Plugins::Plugins() {
  drivers.add(phantom::make_phantom_driver());
  sim::register_arm_models(models);
}

}  // namespace thimble::session
