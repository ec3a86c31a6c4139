#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "daemon/world/world.hpp"

namespace thimble::coupling::testing {

// The inside of a cube centred on the origin; the plainest world there is. One probe.
class FakeBox final : public world::World {
 public:
  explicit FakeBox(double half_m) : half_m_(half_m) {}

  [[nodiscard]] const world::WorldInfo& info() const noexcept override { return info_; }
  [[nodiscard]] Result<world::ProbeId> add_probe(Position3 /*hand*/) override {
    if (is_full) return fail(Errc::Busy, "no room for another probe");
    ++probes;
    return world::ProbeId{next_++};
  }
  void remove_probe(world::ProbeId /*probe*/) noexcept override { --probes; }
  void press(world::ProbeId /*probe*/, std::uint32_t buttons) noexcept override {
    presses.push_back(buttons);
  }
  [[nodiscard]] bool has_actions() const noexcept override { return true; }
  [[nodiscard]] bool act(world::ProbeId /*probe*/, world::HandAction action) noexcept override {
    if (!has_room) return false;
    ++asked.at(static_cast<std::size_t>(action));
    return true;
  }
  world::ProbeMotion move_probe(world::ProbeId /*probe*/, Position3 hand,
                                Duration dt) noexcept override {
    ++moves;
    last_dt = dt;
    world::ProbeMotion motion{
        .ghost = hand, .planes = {}, .is_embedded = is_embedded, .is_silent = is_silent};
    motion.pressure = pressure.value_or(Force3());
    motion.has_pressure = pressure.has_value();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const double sign : {1.0, -1.0}) {
        if (sign * hand[axis] <= half_m_) continue;
        world::ContactPlane plane{.offset_m = half_m_, .stiffness = stiffness, .damping = damping};
        plane.normal[axis] = sign;
        motion.ghost[axis] = sign * half_m_;
        motion.planes.push_back(plane);
      }
    }
    return motion;
  }

  bool is_full{false};
  bool is_embedded{false};
  bool is_silent{false};
  std::vector<std::uint32_t> presses;
  bool has_room{true};  // for what is asked
  std::array<unsigned, world::kHandActions> asked{};
  Stiffness stiffness{-1};
  Damping damping{-1};
  std::optional<Force3> pressure{};
  int probes{0};
  int moves{0};
  Duration last_dt{};

 private:
  double half_m_;
  world::WorldInfo info_{};
  std::uint32_t next_{1};
};

}  // namespace thimble::coupling::testing
