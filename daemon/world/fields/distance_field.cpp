#include "daemon/world/fields/distance_field.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace thimble::world {
namespace {

constexpr std::uint32_t kMostAlong = 1024;
constexpr double kLeastStep_m = 1e-6;
constexpr double kMostStep_m = 10;
constexpr float kFurthest_m = 1000;

// Where along one axis a place is: the node below it, what part of the step it is past it, and how
// far it is beyond the lattice, with its sign.
struct Along {
  std::size_t node{0};
  double part{0};
  double beyond_m{0};
};

Along find_along(double at_m, std::uint32_t numbers, double step_m) noexcept {
  const double last = numbers - 1.0;
  const double exact = at_m / step_m + last / 2;
  const double held = std::clamp(exact, 0.0, last);
  const double node = std::min(std::floor(held), last - 1);
  return {static_cast<std::size_t>(node), held - node, (exact - held) * step_m};
}

}  // namespace

Result<void> DistanceField::check(std::array<std::uint32_t, 3> numbers, double step_m) {
  for (const std::uint32_t count : numbers) {
    if (count < 2 || count > kMostAlong) {
      return fail(
          Errc::InvalidArgument,
          "field: expected 2 to 1024 numbers along each axis, found " + std::to_string(count));
    }
  }
  if (std::uint64_t{numbers[0]} * numbers[1] * numbers[2] > kMaxFieldNumbers) {
    return fail(Errc::TooLarge,
                "field: more than " + std::to_string(kMaxFieldNumbers) + " numbers");
  }
  if (!(step_m >= kLeastStep_m && step_m <= kMostStep_m)) {
    return fail(Errc::InvalidArgument, "field: its step is not between 1e-6 and 10 m");
  }
  return {};
}

Result<DistanceField> DistanceField::create(std::array<std::uint32_t, 3> numbers, double step_m,
                                            std::vector<float> distances_m, Position3 center) {
  if (auto good = check(numbers, step_m); !good) return tl::unexpected(good.error());
  if (distances_m.size() != std::size_t{numbers[0]} * numbers[1] * numbers[2]) {
    return fail(Errc::InvalidArgument, "field: its numbers are not as many as its axes say");
  }
  const auto is_absurd = [](float m) { return !(std::abs(m) <= kFurthest_m); };
  if (std::any_of(distances_m.begin(), distances_m.end(), is_absurd)) {
    return fail(Errc::Malformed, "field: a number is not finite, or beyond 1 km");
  }
  if (!is_finite(center)) return fail(Errc::InvalidArgument, "field: its middle is not finite");
  return DistanceField(numbers, step_m, std::move(distances_m), center);
}

DistanceField::DistanceField(std::array<std::uint32_t, 3> numbers, double step_m,
                             std::vector<float> distances_m, Position3 center)
    : numbers_(numbers),
      step_m_(step_m),
      center_(center - Position3{}),
      distances_m_(std::move(distances_m)),
      steepest_(norm(find_steepest(), 1, 0)) {}

// Between nodes no derivative is larger than the largest difference along an edge of the cell;
// beyond the lattice the way to it adds 1 across.
double DistanceField::find_steepest() const noexcept {
  std::array<double, 3> most_m{};
  for (std::size_t z = 0; z < numbers_[2]; ++z) {
    for (std::size_t y = 0; y < numbers_[1]; ++y) {
      for (std::size_t x = 0; x < numbers_[0]; ++x) {
        const double here_m = node_m(x, y, z);
        if (x > 0) most_m[0] = std::max(most_m[0], std::abs(here_m - node_m(x - 1, y, z)));
        if (y > 0) most_m[1] = std::max(most_m[1], std::abs(here_m - node_m(x, y - 1, z)));
        if (z > 0) most_m[2] = std::max(most_m[2], std::abs(here_m - node_m(x, y, z - 1)));
      }
    }
  }
  return norm(most_m[0], most_m[1], most_m[2]) / step_m_;
}

FieldLook DistanceField::look(Position3 place) const noexcept {
  const Position3 at = place - center_;
  const std::array<Along, 3> along_axes{find_along(at.x, numbers_[0], step_m_),
                                        find_along(at.y, numbers_[1], step_m_),
                                        find_along(at.z, numbers_[2], step_m_)};
  const auto& [x, y, z] = along_axes;
  double distance_m = 0;
  Displacement3 rise{};  // per step
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const std::size_t i = corner & 1;
    const std::size_t j = corner >> 1 & 1;
    const std::size_t k = corner >> 2;
    const double value_m = node_m(x.node + i, y.node + j, z.node + k);
    const double a = i == 0 ? 1 - x.part : x.part;
    const double b = j == 0 ? 1 - y.part : y.part;
    const double c = k == 0 ? 1 - z.part : z.part;
    distance_m += a * b * c * value_m;
    rise.x += (i == 0 ? -value_m : value_m) * b * c;
    rise.y += (j == 0 ? -value_m : value_m) * a * c;
    rise.z += (k == 0 ? -value_m : value_m) * a * b;
  }
  Displacement3 gradient = (1 / step_m_) * rise;
  const Displacement3 beyond{x.beyond_m, y.beyond_m, z.beyond_m};
  const double beyond_m = norm(beyond);
  if (beyond_m > 0) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (beyond[axis] != 0) gradient[axis] = beyond[axis] / beyond_m;
    }
  }
  FieldLook out{distance_m + beyond_m, {0, 1, 0}, norm(gradient)};
  if (out.slope > 0) {
    out.outward = {gradient.x / out.slope, gradient.y / out.slope, gradient.z / out.slope};
  }
  return out;
}

}  // namespace thimble::world
