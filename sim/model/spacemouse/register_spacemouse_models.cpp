#include "sim/model/spacemouse/register_spacemouse_models.hpp"

#include <memory>

#include "sim/model/spacemouse/puck_model.hpp"

namespace thimble::sim {

void register_spacemouse_models(plugin::SimModelRegistry& registry) {
  registry.add({"spacemouse", "3Dconnexion SpaceMouse, input only (HID)",
                [](const plugin::SimModelSettings&) {
                  return std::make_unique<PuckModel>(combined_puck());
                }});
  registry.add({"spacenavigator", "3Dconnexion SpaceNavigator, input only (HID)",
                [](const plugin::SimModelSettings&) {
                  return std::make_unique<PuckModel>(separate_puck());
                }});
}

}  // namespace thimble::sim
