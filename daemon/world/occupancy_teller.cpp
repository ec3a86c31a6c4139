#include "daemon/world/occupancy_teller.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>

namespace thimble::world {
namespace {

// Ours: 2 s at 1 kHz, half a second at 4 kHz: no answer is under way longer.
constexpr std::size_t kAnswers = 2048;
constexpr std::size_t kFarLooks = 8;
constexpr int kWindow = static_cast<int>(kWindowEdge_blocks);
constexpr std::uint64_t kKnown = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint16_t kNowhere = std::numeric_limits<std::uint16_t>::max();

struct Offset {
  std::array<std::int8_t, 3> by{};
  int squared{0};
};
using Offsets = std::array<Offset, kMirrorSlots>;

// A window of 8 blocks an edge about a block, the nearest first.
const Offsets& nearest_first() {
  static const Offsets kOffsets = [] {
    Offsets offsets;
    std::size_t n = 0;
    for (int z = -kWindow / 2; z < kWindow / 2; ++z) {
      for (int y = -kWindow / 2; y < kWindow / 2; ++y) {
        for (int x = -kWindow / 2; x < kWindow / 2; ++x) {
          offsets[n++] = {{static_cast<std::int8_t>(x), static_cast<std::int8_t>(y),
                           static_cast<std::int8_t>(z)},
                          x * x + y * y + z * z};
        }
      }
    }
    std::stable_sort(offsets.begin(), offsets.end(),
                     [](const Offset& a, const Offset& b) { return a.squared < b.squared; });
    return offsets;
  }();
  return kOffsets;
}

bool is_near(const Offset& offset) {
  return std::all_of(offset.by.begin(), offset.by.end(), [](int by) { return std::abs(by) <= 1; });
}

// The first block of the window along an axis with as many: about the middle, and within the world.
int window_begin(int middle, int blocks) {
  return std::clamp(middle - kWindow / 2, 0, std::max(0, blocks - kWindow));
}

// Eight cells of a row, one bit each from `from` up; those beyond the grid are occupied.
std::uint64_t row_of(const VoxelGrid& grid, Cell from) noexcept {
  constexpr std::uint64_t kAll = 0xFF;
  if (!grid.is_inside(from)) return kAll;
  const std::size_t inside = std::min(grid.cells()[0] - static_cast<std::size_t>(from.x),
                                      static_cast<std::size_t>(kBlockEdge_cells));
  return grid.bits_in_row(from, inside) | (kAll << inside & kAll);
}

std::uint64_t slice_of(const VoxelGrid& grid, const std::array<std::int16_t, 3>& at,
                       std::int32_t z) noexcept {
  std::uint64_t slice = 0;
  for (std::int32_t y = 0; y < kBlockEdge_cells; ++y) {
    const std::uint64_t row = row_of(grid, {at[0] * kBlockEdge_cells, at[1] * kBlockEdge_cells + y,
                                            at[2] * kBlockEdge_cells + z});
    slice |= row << static_cast<unsigned>(kBlockEdge_cells * y);
  }
  return slice;
}

// Calls `visit` with the blocks of the window about `middle`, the nearest first.
void visit_window(const VoxelGrid& grid, const std::array<std::int16_t, 3>& middle,
                  const auto& visit) {
  std::array<int, 3> begin{};
  std::array<int, 3> end{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto cells = static_cast<int>(grid.cells()[axis]);
    const int blocks = (cells + kBlockEdge_cells - 1) / kBlockEdge_cells;
    begin[axis] = window_begin(middle[axis], blocks);
    end[axis] = std::min(begin[axis] + kWindow, blocks);
  }
  for (const Offset& offset : nearest_first()) {
    std::array<std::int16_t, 3> at{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      // Beyond one side of the window there is as much on the other.
      int place = middle[axis] + offset.by[axis];
      if (place < begin[axis]) place += kWindow;
      if (place >= begin[axis] + kWindow) place -= kWindow;
      at[axis] = static_cast<std::int16_t>(place);
    }
    if (at[0] < end[0] && at[1] < end[1] && at[2] < end[2]) visit(at, offset);
  }
}

}  // namespace

void OccupancyTeller::reset() {
  slots_.assign(kMirrorSlots, Slot{});
  answers_.assign(kAnswers, Answer{});
  window_.clear();  // center() makes it and what goes with it
  window_.reserve(kMirrorSlots);
  told_in_.reserve(kMirrorSlots);
  places_.assign(kMirrorSlots, kNowhere);
  told_ = 0;
  versions_ = 0;
  turn_ = 0;
  looks_ = 0;
  is_quiet_ = false;
}

void OccupancyTeller::forget() noexcept {
  const std::uint32_t versions = is_used_up() ? 0 : versions_;
  reset();
  versions_ = versions;
}

void OccupancyTeller::acknowledge(std::uint64_t newest, std::uint64_t before) noexcept {
  if (newest == 0 || newest > told_) return;
  apply(newest);
  for (std::uint64_t i = 0; i < 64 && i + 1 < newest; ++i) {
    if (((before >> i) & 1U) != 0) apply(newest - 1 - i);
  }
}

// Once: he says it in each sample until 64 others came after it.
void OccupancyTeller::apply(std::uint64_t number) noexcept {
  Answer& answer = answers_[number % kAnswers];
  if (answer.number != number) return;
  for (std::size_t i = 0; i < answer.count; ++i) {
    const std::uint16_t which = answer.slots[i];
    Slot& slot = slots_[which];
    slot.known_version = std::max(slot.known_version, answer.versions[i]);
    if (places_[which] != kNowhere) mark(places_[which]);
  }
  answer.count = 0;
}

void OccupancyTeller::center(const VoxelGrid& grid, const At& middle) noexcept {
  middle_ = middle;
  window_.clear();
  told_in_.clear();
  near_ = 0;
  std::fill(places_.begin(), places_.end(), kNowhere);
  visit_window(grid, middle, [&](const At& at, const Offset& offset) {
    const std::size_t place = window_.size();
    if (is_near(offset)) near_ = place + 1;
    places_[slot_of(at)] = static_cast<std::uint16_t>(place);
    window_.push_back(at);
    told_in_.push_back(kKnown);
    mark(place);
  });
}

// What has not been looked at since the window moved is not told: the slot has another block.
void OccupancyTeller::mark(std::size_t place) noexcept {
  const Slot& slot = slots_[slot_of(window_[place])];
  const bool is_open = slot.holds(window_[place]) && slot.known_version != slot.block.version;
  told_in_[place] = is_open ? slot.told_in : kKnown;
}

void OccupancyTeller::look_at(const VoxelGrid& grid, std::size_t place) noexcept {
  const At& at = window_[place];
  Slot& slot = slots_[slot_of(at)];
  const bool is_mine = slot.holds(at);
  if (is_mine && slot.seen_at == grid.revision()) return;
  slot.seen_at = grid.revision();
  std::array<std::uint64_t, kBlockSlices> slices{};
  for (std::int32_t z = 0; z < kBlockEdge_cells; ++z) {
    slices[static_cast<std::size_t>(z)] = slice_of(grid, at, z);
  }
  if (is_mine && slot.block.slices == slices) return;
  slot.block = {at, ++versions_, slices};
  slot.told_in = 0;
  mark(place);
}

void OccupancyTeller::look_around(const VoxelGrid& grid) noexcept {
  for (std::size_t place = 0; place < near_; ++place) look_at(grid, place);
  for (std::size_t i = 0; i < kFarLooks; ++i) {
    const std::size_t place = (turn_ + i) % kMirrorSlots;
    if (place >= near_ && place < window_.size()) look_at(grid, place);
  }
  turn_ = (turn_ + kFarLooks) % kMirrorSlots;
  looks_ += kFarLooks;
}

ToldBlocks OccupancyTeller::tell(const VoxelGrid& grid, Cell ghost, std::uint64_t number) noexcept {
  const At middle = block_of(ghost);
  told_ = number;
  Answer& answer = answers_[number % kAnswers];
  answer = {.number = number};
  ToldBlocks told;
  const bool is_elsewhere = window_.empty() || middle_ != middle;
  if (is_elsewhere) center(grid, middle);
  if (is_elsewhere || revision_ != grid.revision()) {
    revision_ = grid.revision();
    looks_ = 0;
    is_quiet_ = false;
  }
  if (is_quiet_) return told;
  // Once around, all has been looked at as it is.
  if (looks_ < kMirrorSlots) look_around(grid);
  for (const std::size_t place : choose()) {
    const std::size_t which = slot_of(window_[place]);
    Slot& slot = slots_[which];
    slot.told_in = number;
    mark(place);
    answer.slots[answer.count] = static_cast<std::uint16_t>(which);
    answer.versions[answer.count++] = slot.block.version;
    told.push_back(slot.block);
  }
  is_quiet_ = looks_ >= kMirrorSlots && told.empty();
  return told;
}

OccupancyTeller::Chosen OccupancyTeller::choose() const noexcept {
  Chosen chosen;
  std::uint64_t before = kKnown;  // what comes among the chosen was told before
  for (std::size_t place = 0; place < told_in_.size(); ++place) {
    if (told_in_[place] >= before) continue;
    // Of those told equally long ago the nearer, which was met first, stays before.
    if (chosen.size() < kMostBlocksTold) chosen.push_back(place);
    std::size_t i = chosen.size() - 1;
    for (; i > 0 && told_in_[chosen[i - 1]] > told_in_[place]; --i) chosen[i] = chosen[i - 1];
    chosen[i] = place;
    if (chosen.size() < kMostBlocksTold) continue;
    before = told_in_[chosen[kMostBlocksTold - 1]];
    if (before == 0) break;  // no other comes before four that were never told
  }
  return chosen;
}

std::size_t OccupancyTeller::open_blocks() const noexcept {
  return static_cast<std::size_t>(std::count_if(slots_.begin(), slots_.end(), [](const Slot& slot) {
    return slot.block.version != slot.known_version;
  }));
}

}  // namespace thimble::world
