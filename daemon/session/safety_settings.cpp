#include "daemon/session/safety_settings.hpp"

namespace thimble::session {
namespace {

// Away from the level of a closed contact: a broken wire is an open one.
bus::GpioPull pull_of(const config::SafetyConfig& safety) {
  if (safety.pull == config::PullResistor::External) return bus::GpioPull::AsIs;
  return safety.closed_level == config::ClosedLevel::Low ? bus::GpioPull::Up : bus::GpioPull::Down;
}

}  // namespace

bus::GpioClaim make_gpio_claim(const config::SafetyConfig& safety) {
  bus::GpioClaim claim{safety.chip, safety.estop, {}, pull_of(safety)};
  if (safety.deadman) claim.inputs.push_back(*safety.deadman);
  if (safety.enable) claim.outputs.push_back(*safety.enable);
  if (safety.lamp) claim.outputs.push_back(*safety.lamp);
  return claim;
}

safety::ChainSettings make_chain_settings(const config::SafetyConfig& safety) {
  return {.estop_channels = safety.estop.size(),
          .is_closed_high = safety.closed_level == config::ClosedLevel::High,
          .has_deadman = safety.deadman.has_value(),
          .has_enable = safety.enable.has_value(),
          .has_lamp = safety.lamp.has_value()};
}

}  // namespace thimble::session
