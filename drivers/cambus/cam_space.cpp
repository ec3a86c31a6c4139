#include "drivers/cambus/cam_space.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

#include "drivers/cambus/cambus_wire.hpp"
#include "drivers/cambus/video_timing.hpp"

namespace thimble::cambus {
namespace {

constexpr std::array<std::string_view, 3> kAxisNames{"x", "y", "z"};
constexpr int kMostPerAxis_log2 = 2;

std::uint32_t gray(std::uint32_t n) { return n ^ (n >> 1); }

// The number whose reflected code this is, of at most two bits: neighbours on a ring differ by one.
std::uint32_t from_gray(std::uint32_t code) { return code ^ (code >> 1); }

bool is_strip(Division division) { return division != Division::Mesh; }
std::size_t strip_axis(Division division) {
  return static_cast<std::size_t>(division) - static_cast<std::size_t>(Division::StripX);
}

}  // namespace

Axes position_of(const BoardShape& board, int module) noexcept {
  std::uint32_t code = gray(static_cast<std::uint32_t>(module));
  Axes position{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int bits = board.log2_modules[axis];
    position[axis] = static_cast<int>(from_gray(code & ((1U << bits) - 1U)));
    code >>= bits;
  }
  return position;
}

std::size_t pin_to_next(const BoardShape& board, int module) noexcept {
  const int modules = board.modules();
  const Axes here = position_of(board, module);
  const Axes next = position_of(board, (module + 1) % modules);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (here[axis] == next[axis]) continue;
    const int length = 1 << board.log2_modules[axis];
    // Two along an axis are joined by two wires; where there are only two, both are on the way.
    const bool is_plus =
        length == 2 ? here[axis] == 0 || modules == 2 : (here[axis] + 1) % length == next[axis];
    return 2 * axis + (is_plus ? 1 : 0);
  }
  return 0;
}

Result<CamSpace> CamSpace::make(const BoardShape& board, const Axes& log2_cells,
                                Division division) {
  CamSpace space;
  space.board_ = board;
  space.division_ = division;
  const int all = board.log2_modules[0] + board.log2_modules[1] + board.log2_modules[2];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int along = board.log2_modules[axis];
    if (along < 0 || along > kMostPerAxis_log2) {
      return fail(Errc::InvalidArgument, "a board has 1, 2 or 4 modules along each axis");
    }
    const int parts = !is_strip(division) ? along : axis == strip_axis(division) ? all : 0;
    space.log2_parts_[axis] = parts;
    space.sector_[axis] = log2_cells[axis] - parts;
    if (log2_cells[axis] < 0 || log2_cells[axis] > kAddressBits ||
        (parts > 0 && space.sector_[axis] < 1)) {
      return fail(Errc::InvalidArgument, "2^" + std::to_string(log2_cells[axis]) + " cells along " +
                                             std::string(kAxisNames[axis]) + " do not go onto 2^" +
                                             std::to_string(parts) + " modules");
    }
  }
  if (board.log2_sites > kAddressBits || space.log2_sector_sites() > board.log2_sites) {
    return fail(Errc::InvalidArgument, "2^" + std::to_string(space.log2_sector_sites()) +
                                           " cells for a module are more than the 2^" +
                                           std::to_string(board.log2_sites) + " that it has");
  }
  return space;
}

int CamSpace::first_bit(std::size_t axis) const noexcept {
  int bit = 0;
  for (std::size_t before = 0; before < axis; ++before) bit += sector_[before];
  return bit;
}

CellPlace CamSpace::place_of(const Axes& cell) const noexcept {
  CellPlace place;
  Axes part{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int inside = cell[axis] & ((1 << sector_[axis]) - 1);
    part[axis] = cell[axis] >> sector_[axis];
    place.site |= static_cast<std::uint32_t>(inside) << first_bit(axis);
  }
  if (is_strip(division_)) {
    place.module = part[strip_axis(division_)];
    return place;
  }
  while (place.module < modules() && position_of(board_, place.module) != part) ++place.module;
  return place;
}

Result<CamRaster> CamSpace::raster(int slice) const {
  const auto log2_cells = [&](std::size_t axis) { return sector_[axis] + log2_parts_[axis]; };
  if (slice < 0 || slice >= 1 << log2_cells(2)) {
    return fail(Errc::InvalidArgument, "there is no slice " + std::to_string(slice));
  }
  if (is_divided(0)) {
    return fail(Errc::InvalidArgument, "a row of cells has to be within one module to be shown");
  }
  if (log2_cells(0) > kLog2LineSites || log2_cells(1) > kLog2Lines) {
    return fail(Errc::TooLarge, "a monitor shows 512 rows of 512 cells at most");
  }
  const int inside = slice & ((1 << sector_[2]) - 1);
  CamRaster raster{
      {{0, 0, inside}, {sector_[0], 0, 0}}, {{0, 0, inside}, {sector_[0], sector_[1], 0}}, {}};
  for (int strip = 0; strip < 1 << log2_parts_[1]; ++strip) {
    raster.modules.push_back(place_of({0, strip << sector_[1], slice}).module);
  }
  return raster;
}

RegisterWords CamSpace::dimension() const {
  RegisterWords words = default_words(Register::Dimension);
  std::uint32_t cuts = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int last = first_bit(axis) + sector_[axis] - 1;
    if (last < 0) continue;
    if (last < kAddressBits - 1) cuts |= 1U << last;
    if (is_divided(axis)) words.set(field::kDimension[1 + axis], static_cast<std::uint32_t>(last));
  }
  return words.set(field::kCuts, cuts);
}

RegisterWords CamSpace::connect(int module) const {
  if (is_strip(division_) && modules() > 1) return strip_connect(module, strip_axis(division_));
  return default_words(Register::Connect);
}

RegisterWords CamSpace::strip_connect(int module, std::size_t axis) const {
  RegisterWords words(Register::Connect);
  for (const Field& pin : field::kConnect) words.set(pin, kPinIs1);
  const auto minus = static_cast<std::uint32_t>(2 * axis);
  const std::size_t to_next = pin_to_next(board_, module);
  const std::size_t from_last = pin_to_next(board_, (module + modules() - 1) % modules()) ^ 1U;
  words.set(field::kConnect[from_last], minus).set(field::kConnect[to_next], minus + 1);
  return words;
}

Result<RegisterWords> CamSpace::kick(std::span<const LayerKick> kicks) const {
  RegisterWords words(Register::Kick);
  for (const LayerKick& kick : kicks) {
    std::uint32_t amount = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int cells = kick.cells[axis];
      const int length = 1 << sector_[axis];
      if (is_divided(axis) && (cells > length || cells < -length)) {
        return fail(Errc::InvalidArgument, "a kick of " + std::to_string(cells) + " cells along " +
                                               std::string(kAxisNames[axis]) +
                                               " is longer than a module, " +
                                               std::to_string(length));
      }
      amount |= static_cast<std::uint32_t>(cells & (length - 1)) << first_bit(axis);
      const bool is_minus = is_divided(axis) && cells < 0;
      const bool is_most = is_divided(axis) && cells == length;
      words.set(field::kKick[1 + axis], is_minus ? 1 : 0, kick.layers)
          .set(field::kKick[4 + axis], is_most ? 1 : 0, kick.layers);
    }
    words.set(field::kKickAmount, amount, kick.layers);
  }
  return words;
}

}  // namespace thimble::cambus
