#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "daemon/coupling/remote_force_arm.hpp"
#include "daemon/coupling/remote_force_world.hpp"
#include "daemon/coupling/spring_damper_arm.hpp"
#include "daemon/coupling/spring_damper_world.hpp"
#include "daemon/coupling/wave_arm.hpp"
#include "daemon/coupling/wave_world.hpp"
#include "daemon/world/world.hpp"

namespace thimble::coupling::testing {

// A scheme that computes at the far end, as it is made where nothing else is said.
struct FarEndScheme {
  std::string name;
  std::function<std::unique_ptr<ArmCoupling>()> make_arm;
  std::function<std::unique_ptr<WorldCoupling>(world::World&, std::uint32_t first_session)>
      make_world;
  // What a hand at rest feels of a world that fell silent, until it fades: the last force. Of waves
  // nothing, as none arrives: only a hand that moves feels a damper (Wave.InAGap).
  bool keeps_force{true};
};

template <class Arm, class World>
FarEndScheme far_end_scheme(const std::string& name, bool keeps_force = true) {
  return {name, [] { return std::make_unique<Arm>(); },
          [](world::World& world, std::uint32_t first_session) {
            return std::make_unique<World>(world, first_session);
          },
          keeps_force};
}

inline std::vector<FarEndScheme> far_end_schemes() {
  return {
      far_end_scheme<RemoteForceArm, RemoteForceWorld>("remote-force"),
      far_end_scheme<SpringDamperArm, SpringDamperWorld>("spring-damper"),
      far_end_scheme<WaveArm, WaveWorld>("wave", false),
      {"spring-damper, force at both ends",
       [] {
         return std::make_unique<SpringDamperArm>(SpringDamperSettings{.force_at = ForceAt::Both});
       },
       [](world::World& world, std::uint32_t first_session) {
         return std::make_unique<SpringDamperWorld>(world, first_session, ForceAt::Both);
       }}};
}

}  // namespace thimble::coupling::testing
