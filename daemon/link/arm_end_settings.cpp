#include "daemon/link/arm_end_settings.hpp"

namespace thimble::link {

ThesisArmEnd make_thesis_end(const ArmEndSettings& settings) {
  return ThesisArmEnd({.mode = settings.mode, .impairment = settings.impairment});
}

ThimbleArmEnd make_thimble_end(const ArmEndSettings& settings) {
  return {{.mode = settings.mode,
           .impairment = settings.impairment,
           .key = settings.key,
           .half = settings.half,
           .else_half = settings.else_half,
           .deadband_m = settings.deadband_m},
          system_random()};
}

}  // namespace thimble::link
