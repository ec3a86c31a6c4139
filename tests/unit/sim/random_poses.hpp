#pragma once

#include <random>

#include "sim/model/arm/arm_dynamics.hpp"

namespace thimble::sim {

// Seeded poses within the end stops.
class RandomPoses {
 public:
  RandomPoses(const ArmDynamics& dynamics, std::uint32_t seed)
      : dynamics_(dynamics), generator_(seed) {}

  JointVector pose() {
    const ArmParameters& p = dynamics_.parameters();
    while (true) {
      JointVector q{};
      for (std::size_t i = 0; i < 3; ++i) {
        q[i] = uniform(p.joint_range[i].min_rad, p.joint_range[i].max_rad);
      }
      if (dynamics_.is_within_stops(q)) return q;
    }
  }
  JointVector rate(double limit_rad_per_s) {
    JointVector v{};
    for (double& value : v) value = uniform(-limit_rad_per_s, limit_rad_per_s);
    return v;
  }
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }

 private:
  const ArmDynamics& dynamics_;
  std::mt19937 generator_;
};

}  // namespace thimble::sim
