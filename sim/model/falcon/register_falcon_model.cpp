#include "sim/model/falcon/register_falcon_model.hpp"

#include <memory>
#include <string>

#include "drivers/falcon/falcon_models.hpp"
#include "sim/model/falcon/falcon_arm_model.hpp"

namespace thimble::sim {

void register_falcon_model(plugin::SimModelRegistry& registry) {
  const falcon::FalconModel& model = falcon::kFalconModels[0];
  plugin::SimModelEntry entry{std::string(model.name), std::string(model.description) + " (USB)"};
  entry.create_usb = [](const plugin::SimModelSettings&) {
    return std::make_unique<FalconArmModel>(falcon_parameters());
  };
  registry.add(std::move(entry));
}

}  // namespace thimble::sim
