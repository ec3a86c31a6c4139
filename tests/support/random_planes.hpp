#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "daemon/world/plane_projection.hpp"

namespace thimble::test {

// Planes that lie any way, as seen from a hand that is past some of them.
class RandomPlanes {
 public:
  explicit RandomPlanes(std::uint32_t seed) : random_(seed) {}

  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(random_()) / 4294967295.0;
  }
  std::size_t below(std::size_t end) { return random_() % end; }
  Direction3 direction() {
    for (;;) {
      const Direction3 v{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
      const double length = norm(v);
      if (length > 0.1 && length < 1) return {v.x / length, v.y / length, v.z / length};
    }
  }
  Displacement3 displacement(double most_m) {
    return along<DisplacementTag>(direction(), uniform(0, most_m));
  }

  // All leave the place free that is up to 3 cm from the hand; its planes are up to 1 cm from it.
  world::PastPlanes around_a_free_place(std::size_t count) {
    const Displacement3 from_place = displacement(0.03);
    world::PastPlanes planes;
    for (std::size_t i = 0; i < count; ++i) {
      const Direction3 normal = direction();
      planes.push_back({normal, dot(normal, from_place) - uniform(0, 0.01)});
    }
    return planes;
  }

  // Parallel, opposite, coplanar, and off that by anything from nothing to a degree.
  world::PastPlanes degenerate(std::size_t count) {
    const Direction3 first = direction();
    const Direction3 second = direction();
    world::PastPlanes planes;
    for (std::size_t i = 0; i < count; ++i) {
      const double a = static_cast<double>(below(3)) - 1;
      const double b = below(2) == 0 ? 0 : uniform(-1, 1);
      const double off = below(3) == 0 ? 0 : std::pow(10, uniform(-12, -2));
      Direction3 normal = a * first + b * second + off * direction();
      const double length = norm(normal);
      if (length < 1e-3) normal = first;
      if (length >= 1e-3) normal = (1 / length) * normal;
      planes.push_back({normal, uniform(-0.01, 0.01)});
    }
    return planes;
  }

 private:
  std::mt19937 random_;
};

}  // namespace thimble::test
