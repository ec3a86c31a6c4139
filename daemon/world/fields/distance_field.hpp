#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hal/base/geometry.hpp"
#include "hal/base/result.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::world {

// Ours: 256 MiB of floats.
inline constexpr std::uint64_t kMaxFieldNumbers = std::uint64_t{1} << 26;

// What a field says of a place.
struct FieldLook {
  double distance_m{0};  // to the surface, < 0 inside
  Direction3 outward{0, 1, 0};
  double slope{0};  // length of the gradient; 1 of a true distance, 0: outward means nothing
};

// A signed distance field: numbers at the nodes of a cubic lattice, its middle at `center`, and
// what lies between them by trilinear interpolation. Beyond the lattice the distance grows with the
// way to it. It need not be a true distance: steepest() bounds how fast it falls anywhere, so that
// a way of distance/steepest passes no surface.
//
// Thread: reading from any. RT: look() THIMBLE_RT; create() allocates.
class DistanceField {
 public:
  // `numbers`: nodes along x, y, z, each 2 to 1024; `distances_m`: x fastest, as many.
  // InvalidArgument: counts or the step make no sense; TooLarge: above kMaxFieldNumbers; Malformed:
  // a number is not finite or beyond 1 km.
  [[nodiscard]] static Result<DistanceField> create(std::array<std::uint32_t, 3> numbers,
                                                    double step_m, std::vector<float> distances_m,
                                                    Position3 center = {});
  // What create() would say of counts and step.
  [[nodiscard]] static Result<void> check(std::array<std::uint32_t, 3> numbers, double step_m);

  [[nodiscard]] THIMBLE_RT FieldLook look(Position3 at) const noexcept;
  // At least 1.
  [[nodiscard]] double steepest() const noexcept { return steepest_; }
  [[nodiscard]] double step_m() const noexcept { return step_m_; }
  [[nodiscard]] const std::array<std::uint32_t, 3>& numbers() const noexcept { return numbers_; }

 private:
  DistanceField(std::array<std::uint32_t, 3> numbers, double step_m, std::vector<float> distances_m,
                Position3 center);
  [[nodiscard]] double node_m(std::size_t x, std::size_t y, std::size_t z) const noexcept {
    return distances_m_[(z * numbers_[1] + y) * numbers_[0] + x];
  }
  [[nodiscard]] double find_steepest() const noexcept;

  std::array<std::uint32_t, 3> numbers_;
  double step_m_;
  Displacement3 center_;  // from the origin
  std::vector<float> distances_m_;
  double steepest_;
};

}  // namespace thimble::world
