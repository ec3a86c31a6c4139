#include "sim/model/falcon/register_falcon_model.hpp"

#include <memory>
#include <string>

#include "drivers/falcon/falcon_models.hpp"
#include "sim/model/falcon/falcon_arm_model.hpp"

namespace thimble::sim {

void register_falcon_model(plugin::SimModelRegistry& registry) {
  const falcon::FalconModel& model = falcon::kFalconModels[0];
  const std::string name(model.name);
  const std::string description(model.description);
  plugin::SimModelEntry empty{name, description + " (USB)"};
  empty.create_usb = [](const plugin::SimModelSettings&) {
    return std::make_unique<FalconArmModel>(falcon_parameters());
  };
  registry.add(std::move(empty));
  plugin::SimModelEntry loaded{name + "-loaded", description + " (USB), loaded"};
  loaded.create_usb = [](const plugin::SimModelSettings&) {
    auto arm = std::make_unique<FalconArmModel>(falcon_parameters());
    arm->load_firmware();
    return arm;
  };
  registry.add(std::move(loaded));
}

}  // namespace thimble::sim
