#include "daemon/world/fields/mesh_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "daemon/world/fields/mesh_distance.hpp"
#include "daemon/world/fields/mesh_winding.hpp"
#include "daemon/world/fields/place_text.hpp"

namespace thimble::world {
namespace {

constexpr double kMargin_steps = 2;
constexpr double kExact_steps = 3;
constexpr std::uint64_t kMostLooks = std::uint64_t{1} << 31;
constexpr double kLeastEdge_m = 1e-4;
constexpr double kMostEdge_m = 10;

// Where the mesh lies in its own numbers, and what it takes to come to metres.
struct Placing {
  Position3 middle{};
  double unit_m{1};
  MeshLattice lattice{};

  [[nodiscard]] Position3 back(Position3 at) const noexcept {
    return middle + (1 / unit_m) * (at - Position3{});
  }
};

[[nodiscard]] Result<Placing> place(const Mesh& mesh, const MeshFieldOptions& options) {
  const auto& [low, high] = box_around(mesh);
  const Displacement3 edges = high - low;
  const double longest = std::max({edges.x, edges.y, edges.z});
  Placing out{low + 0.5 * edges, options.unit_m.value_or(options.longest_m / longest), {}};
  const double longest_m = longest * out.unit_m;
  if (!(longest_m >= kLeastEdge_m && longest_m <= kMostEdge_m)) {
    return fail(Errc::InvalidArgument, "mesh: its longest edge would be " +
                                           std::to_string(longest_m) +
                                           " m, not 1e-4 to 10 m: say what its unit is");
  }
  out.lattice.step_m = longest_m / options.resolution;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double steps = std::ceil(edges[axis] * out.unit_m / out.lattice.step_m - 1e-9);
    const double all = std::max(steps, 0.0) + 2 * kMargin_steps;
    out.lattice.numbers[axis] = static_cast<std::uint32_t>(all) + 1;
    out.lattice.first[axis] = -all / 2 * out.lattice.step_m;
  }
  return out;
}

// From numbers of its own to metres about its middle.
void bring(Mesh& mesh, const Placing& placing) noexcept {
  for (Position3& corner : mesh.corners) {
    corner = Position3{} + placing.unit_m * (corner - placing.middle);
  }
}

// Distances at the nodes of a lattice. Every fourth node along each axis knows the triangle that is
// nearest to it; these are the guesses for the nodes between, and where none of them can be near,
// the nearest of the guesses is enough.
class Measure {
 public:
  Measure(const Mesh& mesh, const MeshLattice& lattice) : lattice_(lattice), distance_(mesh) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      rough_[axis] = (lattice.numbers[axis] - 1) / kEvery + 1;
    }
    known_.reserve(rough_[0] * rough_[1] * rough_[2]);
    for (std::size_t z = 0; z < rough_[2]; ++z) {
      for (std::size_t y = 0; y < rough_[1]; ++y) {
        for (std::size_t x = 0; x < rough_[0]; ++x) {
          const std::size_t i = known_.size();
          const std::array<std::uint32_t, 3> guesses{before(i, x > 0 ? 1 : 0),
                                                     before(i, y > 0 ? rough_[0] : 0),
                                                     before(i, z > 0 ? rough_[0] * rough_[1] : 0)};
          known_.push_back(
              distance_.find(lattice.node(x * kEvery, y * kEvery, z * kEvery), guesses));
        }
      }
    }
  }

  [[nodiscard]] double find_m(std::size_t x, std::size_t y, std::size_t z) {
    std::array<std::uint32_t, 8> guesses{};
    for (std::size_t i = 0; i < guesses.size(); ++i) {
      guesses[i] = known(x / kEvery + (i & 1U), y / kEvery + (i >> 1U & 1U), z / kEvery + (i >> 2U))
                       .triangle;
    }
    const Position3 at = lattice_.node(x, y, z);
    const Position3 from = lattice_.node(x - x % kEvery, y - y % kEvery, z - z % kEvery);
    const double least_m = known(x / kEvery, y / kEvery, z / kEvery).distance_m - norm(at - from);
    const bool is_far = least_m > kExact_steps * lattice_.step_m;
    return (is_far ? distance_.nearest_of(at, guesses) : distance_.find(at, guesses)).distance_m;
  }
  [[nodiscard]] bool is_too_long() const noexcept { return distance_.looks() > kMostLooks; }

 private:
  static constexpr std::size_t kEvery = 4;

  [[nodiscard]] std::uint32_t before(std::size_t i, std::size_t by) const noexcept {
    return by == 0 ? 0 : known_[i - by].triangle;
  }
  [[nodiscard]] const MeshDistance::Nearest& known(std::size_t x, std::size_t y,
                                                   std::size_t z) const noexcept {
    const std::size_t held_x = std::min(x, rough_[0] - 1);
    const std::size_t held_y = std::min(y, rough_[1] - 1);
    const std::size_t held_z = std::min(z, rough_[2] - 1);
    return known_[(held_z * rough_[1] + held_y) * rough_[0] + held_x];
  }

  const MeshLattice& lattice_;
  MeshDistance distance_;
  std::array<std::size_t, 3> rough_{};
  std::vector<MeshDistance::Nearest> known_{};
};

// Turns winding numbers to distances.
[[nodiscard]] Result<void> measure(const Mesh& mesh, const Placing& placing,
                                   std::vector<float>& numbers) {
  const auto& [nx, ny, nz] = placing.lattice.numbers;
  Measure lattice(mesh, placing.lattice);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::size_t x = i % nx;
    const std::size_t y = i / nx % ny;
    const std::size_t z = i / nx / ny;
    if (numbers[i] < 0) {
      const Position3 at = placing.back(placing.lattice.node(x, y, z));
      return fail(Errc::InvalidArgument,
                  "mesh: the part of it around " + text_of(at) + " is inside out");
    }
    const double here_m = lattice.find_m(x, y, z);
    numbers[i] = static_cast<float>(numbers[i] > 0 ? -here_m : here_m);
    if (lattice.is_too_long()) {
      return fail(Errc::TooLarge, "mesh: it takes too long; take a lower resolution");
    }
  }
  return {};
}

}  // namespace

Result<DistanceField> make_field(Mesh mesh, const MeshFieldOptions& options) {
  if (options.resolution < kLeastResolution || options.resolution > kMostResolution) {
    return fail(Errc::InvalidArgument, "mesh: a resolution is 8 to 256 steps");
  }
  if (mesh.triangles.size() > kMaxTriangles) {
    return fail(Errc::TooLarge, "mesh: more than " + std::to_string(kMaxTriangles) + " triangles");
  }
  weld(mesh);
  if (auto good = check_closed(mesh); !good) return tl::unexpected(good.error());
  const auto placing = place(mesh, options);
  if (!placing) return tl::unexpected(placing.error());
  bring(mesh, *placing);
  auto numbers = find_winding(mesh, placing->lattice);
  if (!numbers) return tl::unexpected(numbers.error());
  if (auto done = measure(mesh, *placing, *numbers); !done) return tl::unexpected(done.error());
  return DistanceField::create(placing->lattice.numbers, placing->lattice.step_m,
                               *std::move(numbers), options.center);
}

}  // namespace thimble::world
