#include "sim/model/arm/register_arm_models.hpp"

#include <memory>
#include <string>

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

// The registry takes plain functions: one for each arm.
template <ArmParameters (*Parameters)()>
Result<std::unique_ptr<plugin::SimHidModel>> create_arm(const plugin::SimModelSettings& settings) {
  return create(Parameters(), settings);
}

template <ArmParameters (*Parameters)()>
void add_arm(plugin::SimModelRegistry& registry) {
  const ArmParameters arm = Parameters();
  registry.add(
      {std::string(arm.name), std::string(arm.description) + " (HID)", &create_arm<Parameters>});
}

}  // namespace

void register_arm_models(plugin::SimModelRegistry& registry) {
  add_arm<&phantom_vintage_parameters>(registry);
  add_arm<&woody_2015_parameters>(registry);
  add_arm<&premium_1_5_parameters>(registry);
  add_arm<&aluhaptics_2_parameters>(registry);
  add_arm<&polhem_1_parameters>(registry);
}

}  // namespace thimble::sim
