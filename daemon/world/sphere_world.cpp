#include "daemon/world/sphere_world.hpp"

#include <cmath>
#include <string>

namespace thimble::world {

SphereWorld::SphereWorld(const SphereScene& scene, const Material& surface)
    : scene_(scene), surface_(surface) {
  info_.source = "sphere";
  info_.sphere = scene;
}

Result<SphereWorld> SphereWorld::create(const SphereScene& scene, const Material& surface) {
  const bool is_finite_scene =
      is_finite(scene.center) && std::isfinite(scene.radius_m) && std::isfinite(scene.floor_m);
  if (!is_finite_scene || !(scene.radius_m > 0)) {
    return fail(Errc::InvalidArgument,
                "sphere: its centre and floor must be finite, its radius above 0");
  }
  if (!(scene.center.y + scene.radius_m > scene.floor_m)) {
    return fail(Errc::InvalidArgument, "sphere: the floor lies above all of it");
  }
  return SphereWorld(scene, surface);
}

Result<ProbeId> SphereWorld::add_probe(Position3 hand) {
  if (!is_finite(hand)) return fail(Errc::InvalidArgument, "probe: the hand's place is not finite");
  for (auto& slot : probes_) {
    if (slot) continue;
    slot = Probe{{++last_id_}, place_ghost(scene_, hand)};
    return slot->id;
  }
  return fail(Errc::Busy, info_.source + ": all " + std::to_string(kMaxProbes) +
                              " probes of the world are taken");
}

void SphereWorld::remove_probe(ProbeId probe) noexcept {
  if (auto* slot = find(probe)) slot->reset();
}

ProbeMotion SphereWorld::move_probe(ProbeId probe, Position3 hand, Duration /*dt*/) noexcept {
  auto* slot = find(probe);
  if (slot == nullptr) return {hand, {}, false};
  ProbeMotion motion = move_ghost(scene_, (*slot)->ghost, hand);
  for (ContactPlane& plane : motion.planes) {
    plane.stiffness = surface_.stiffness;
    plane.damping = surface_.damping;
    plane.friction = surface_.friction;
    plane.temperature_kelvin = surface_.temperature_kelvin;
  }
  return motion;
}

std::optional<SphereWorld::Probe>* SphereWorld::find(ProbeId id) noexcept {
  for (auto& slot : probes_) {
    if (slot && slot->id == id) return &slot;
  }
  return nullptr;
}

}  // namespace thimble::world
