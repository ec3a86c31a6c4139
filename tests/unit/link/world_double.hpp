#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "daemon/coupling/world_coupling.hpp"

namespace thimble::link {

// World half of a scheme for tests: a box with walls at ±15 mm on each axis, as "Hello, voxel!"
// is felt. It offers all six walls, also those not touched, and keeps a record.
class WorldDouble final : public coupling::WorldCoupling {
 public:
  static constexpr double kWall_m = 0.015;

  Result<void> open(const coupling::HandSample& first) override {
    if (refusals > 0) {
      --refusals;
      return fail(Errc::Busy, "the world holds as many hands as it can");
    }
    is_open = true;
    ++opened;
    first_samples.push_back(first);
    replies = 0;
    return {};
  }
  coupling::ConstraintSet answer(const coupling::HandSample& sample,
                                 Duration dt) noexcept override {
    answered_while_closed += is_open ? 0U : 1U;
    steps.push_back(dt);
    samples.push_back(sample);
    coupling::ConstraintSet reply;
    if (!is_silent) ++replies;
    reply.sequence = replies;
    reply.session = opened;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      coupling::ConstraintPlane plane;
      plane.offset_m = kWall_m;
      plane.normal[axis] = 1;
      reply.planes.push_back(plane);
      plane.normal[axis] = -1;
      reply.planes.push_back(plane);
    }
    reply.pressure = pressure.value_or(Force3());
    reply.has_pressure = pressure.has_value();
    if (extra_plane != nullptr) reply.planes.push_back(*extra_plane);
    return reply;
  }
  void close() noexcept override {
    is_open = false;
    ++closed;
  }

  bool is_open{false};
  bool is_silent{false};  // gives the last set again
  int refusals{0};        // of the next opens
  std::uint32_t opened{0};
  std::uint32_t closed{0};
  std::uint64_t replies{0};
  std::uint64_t answered_while_closed{0};
  const coupling::ConstraintPlane* extra_plane{nullptr};
  std::optional<Force3> pressure{};
  std::vector<coupling::HandSample> first_samples;
  std::vector<coupling::HandSample> samples;
  std::vector<Duration> steps;
};

}  // namespace thimble::link
