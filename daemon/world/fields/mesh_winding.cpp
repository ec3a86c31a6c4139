#include "daemon/world/fields/mesh_winding.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace thimble::world {
namespace {

// Fractions of a step that corners are put on: with 1029 steps across, products stay far below
// 2^63.
constexpr int kFractionBits = 14;
constexpr std::int64_t kWhole = std::int64_t{1} << kFractionBits;
constexpr std::uint64_t kMaxTrials = std::uint64_t{1} << 29;

// A corner as the rows see it: where across, exactly; how far along, in steps.
struct RowCorner {
  std::int64_t y{0};
  std::int64_t z{0};
  double x{0};
};

// Rows from `low` to `high`, along one of the two axes across.
struct Rows {
  std::int64_t low{0};
  std::int64_t high{-1};
  [[nodiscard]] std::uint64_t count() const noexcept {
    return high < low ? 0 : static_cast<std::uint64_t>(high - low + 1);
  }
};

Rows rows_between(std::int64_t a, std::int64_t b, std::int64_t c) noexcept {
  const std::int64_t least = std::min({a, b, c});
  const std::int64_t most = std::max({a, b, c});
  return {(least + kWhole - 1) >> kFractionBits, most >> kFractionBits};
}

// Twice the area of the triangle a, b, (y, z): > 0 counterclockwise.
std::int64_t turn(const RowCorner& a, const RowCorner& b, std::int64_t y, std::int64_t z) noexcept {
  return (b.y - a.y) * (z - a.z) - (b.z - a.z) * (y - a.y);
}

// Its sign for a row that lies at (y + e, z + e²), e > 0 and as small as you like: never 0 unless
// a and b are the same.
int side_of(const RowCorner& a, const RowCorner& b, std::int64_t turned) noexcept {
  const auto sign = [](std::int64_t v) { return v > 0 ? 1 : v < 0 ? -1 : 0; };
  if (turned != 0) return sign(turned);
  return a.z != b.z ? sign(a.z - b.z) : sign(b.y - a.y);
}

class Rower {
 public:
  using Corners = std::array<RowCorner, 3>;

  explicit Rower(const MeshLattice& lattice) noexcept : lattice_(lattice) {}

  [[nodiscard]] Corners corners(const Mesh& mesh, const Mesh::Triangle& triangle) const noexcept {
    return {corner(mesh.corners[triangle[0]]), corner(mesh.corners[triangle[1]]),
            corner(mesh.corners[triangle[2]])};
  }
  // Adds to the first node behind each crossing what the winding changes by.
  void cross(const Corners& corners, std::vector<float>& changes) const noexcept {
    const auto& [a, b, c] = corners;
    const Rows ys = rows_between(a.y, b.y, c.y);
    const Rows zs = rows_between(a.z, b.z, c.z);
    for (std::int64_t z = zs.low; z <= zs.high; ++z) {
      for (std::int64_t y = ys.low; y <= ys.high; ++y) cross_row(corners, y, z, changes);
    }
  }

 private:
  [[nodiscard]] RowCorner corner(Position3 at) const noexcept {
    const Displacement3 way = at - lattice_.first;
    const auto whole = [&](double m) {
      return static_cast<std::int64_t>(std::llround(m / lattice_.step_m * double{kWhole}));
    };
    return {whole(way.y), whole(way.z), way.x / lattice_.step_m};
  }
  void cross_row(const Corners& corners, std::int64_t y, std::int64_t z,
                 std::vector<float>& changes) const noexcept {
    const auto& [a, b, c] = corners;
    const std::int64_t past_a = turn(b, c, y * kWhole, z * kWhole);
    const std::int64_t past_b = turn(c, a, y * kWhole, z * kWhole);
    const std::int64_t past_c = turn(a, b, y * kWhole, z * kWhole);
    const std::int64_t area = past_a + past_b + past_c;
    const int side = side_of(b, c, past_a);
    const bool is_met = area != 0 && side == side_of(c, a, past_b) && side == side_of(a, b, past_c);
    if (!is_met) return;
    const double x = (static_cast<double>(past_a) * a.x + static_cast<double>(past_b) * b.x +
                      static_cast<double>(past_c) * c.x) /
                     static_cast<double>(area);
    // Across y, z counterclockwise its outside looks along +x: the row goes out.
    const auto& [nx, ny, nz] = lattice_.numbers;
    const double next = std::clamp(std::floor(x) + 1, 0.0, nx - 1.0);
    const std::size_t row = (static_cast<std::size_t>(z) * ny + static_cast<std::size_t>(y)) * nx;
    changes[row + static_cast<std::size_t>(next)] -= static_cast<float>(side);
  }

  const MeshLattice& lattice_;
};

}  // namespace

Result<std::vector<float>> find_winding(const Mesh& mesh, const MeshLattice& lattice) {
  const auto& [nx, ny, nz] = lattice.numbers;
  const Rower rower(lattice);
  std::uint64_t trials = 0;
  for (const Mesh::Triangle& triangle : mesh.triangles) {
    const auto [a, b, c] = rower.corners(mesh, triangle);
    trials += rows_between(a.y, b.y, c.y).count() * rows_between(a.z, b.z, c.z).count();
    if (trials <= kMaxTrials) continue;
    return fail(Errc::TooLarge, "mesh: too many large triangles for so fine a field");
  }
  std::vector<float> winding(std::size_t{nx} * ny * nz);
  for (const Mesh::Triangle& triangle : mesh.triangles) {
    rower.cross(rower.corners(mesh, triangle), winding);
  }
  for (std::size_t row = 0; row < winding.size(); row += nx) {
    for (std::size_t x = 1; x < nx; ++x) winding[row + x] += winding[row + x - 1];
  }
  return winding;
}

}  // namespace thimble::world
