#include "sim/model/arm/register_arm_models.hpp"

#include <memory>

#include "drivers/phantom/phantom_wire.hpp"
#include "sim/model/arm/phantom_arm_model.hpp"

namespace thimble::sim {
namespace {

Result<std::unique_ptr<plugin::SimHidModel>> create(const ArmParameters& parameters,
                                                    plugin::SimModelSettings settings) {
  if (settings.amplifier_max_a == 0) settings.amplifier_max_a = phantom::wire::kAmplifierSmallA;
  if (!(settings.amplifier_max_a > 0 &&
        settings.amplifier_max_a <= phantom::wire::kLargestCurrentA)) {
    return fail(
        Errc::InvalidArgument,
        "amplifier_max_a must be above 0 A and at most 32.767 A (0: the 3 A of the source)");
  }
  return std::make_unique<PhantomArmModel>(parameters, settings);
}

Result<std::unique_ptr<plugin::SimHidModel>> create_vintage(
    const plugin::SimModelSettings& settings) {
  return create(phantom_vintage_parameters(), settings);
}

Result<std::unique_ptr<plugin::SimHidModel>> create_woody(
    const plugin::SimModelSettings& settings) {
  return create(woody_2015_parameters(), settings);
}

}  // namespace

void register_arm_models(plugin::SimModelRegistry& registry) {
  registry.add(
      {"phantom-vintage", "PHANToM with a WoodenHaptics-family controller (HID)", &create_vintage});
  registry.add({"woody-2015", "WoodenHaptics arm of 2015 (HID)", &create_woody});
}

}  // namespace thimble::sim
