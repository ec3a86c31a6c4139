#include <algorithm>
#include <bit>
#include <cstddef>
#include <string>

#include "drivers/cambus/cam_space.hpp"
#include "drivers/cambus/cambus_wire.hpp"

// What of a module a scan visits, and how long that takes.
namespace thimble::cambus {
namespace {

// Docs/cambus.md, section 5.
constexpr std::uint32_t kRefreshEvery_clocks = 390;
constexpr std::uint32_t kMostRefreshes = 31;
// SOURCE: what a scan of another block takes, docs/cambus.md, sections 3 and 5: 24, 120 and 35 bits
// of scan-index, scan-perm and scan-format, and twice 30 of a kick. Each is a frame of up to 16
// clocks more, and a descriptor of 16 bytes; all but the first have a buffer. And a run.
constexpr std::uint64_t kOtherBlock_clocks = 24 + 120 + 35 + 2 * 30 + 5 * 16;
constexpr std::uint64_t kOtherBlock_bytes = 6 * 16 + 240 + 80 + 2 * 64;

int row_bits(const BoardShape& board) { return board.log2_sites == 24 ? 13 : 12; }

struct Sweeps {
  std::uint32_t count{0};
  std::uint32_t clocks{0};  // of each, without refreshes
  std::uint32_t between_refreshes{0};
  std::uint32_t refreshes{0};
};

Sweeps sweeps_of(const ScanBlock& block, int log2_sweep) {
  const Axes& log2 = block.log2_cells;
  Sweeps sweeps;
  sweeps.count = 1U << (log2[0] + log2[1] + log2[2] - log2_sweep);
  const std::uint32_t a_site = log2_sweep == 0 ? wire::kSlowSite_clocks : 1;
  sweeps.clocks = (a_site << log2_sweep) + wire::kSweepOverhead_clocks;
  sweeps.refreshes = std::min(kMostRefreshes, sweeps.clocks / kRefreshEvery_clocks + 1);
  // However short a scan is, it refreshes: what comes between scans is not known.
  sweeps.between_refreshes =
      std::min(sweeps.count, std::max(1U, kRefreshEvery_clocks / sweeps.clocks));
  return sweeps;
}

// Along one axis.
struct Part {
  int first{0};
  int log2{0};
};
using Parts = std::vector<Part>;

// The least that begins at a multiple of its length and has both.
Part part_around(int first, int last) {
  const auto differing = static_cast<unsigned>(first ^ last);
  const int log2 = static_cast<int>(std::bit_width(differing));
  return {first >> log2 << log2, log2};
}

// Ways to have `cells` from `first` on in modules of 2^log2 each: in one part, and in two where
// that lies around a place at which parts meet.
std::vector<Parts> ways_to_have(int first, int cells, int log2) {
  const int length = 1 << log2;
  const int begin = first & (length - 1);
  const int last = begin + cells - 1;
  if (cells >= length) return {{{0, log2}}};
  if (last >= length) {
    const Part high = part_around(begin, length - 1);
    const Part low = part_around(0, last - length);
    const bool are_apart = (1 << low.log2) <= high.first;
    if (!are_apart) return {{{0, log2}}};
    return {{{0, log2}}, {high, low}};
  }
  const Part one = part_around(begin, last);
  if (one.log2 == 0) return {{one}};
  const int middle = one.first + (1 << (one.log2 - 1));
  return {{one}, {part_around(begin, middle - 1), part_around(middle, last)}};
}

std::vector<ScanBlock> all_of(const std::array<const Parts*, 3>& parts) {
  std::vector<ScanBlock> blocks;
  for (const Part& z : *parts[2]) {
    for (const Part& y : *parts[1]) {
      for (const Part& x : *parts[0]) {
        blocks.push_back({{x.first, y.first, z.first}, {x.log2, y.log2, z.log2}});
      }
    }
  }
  return blocks;
}

}  // namespace

int CamSpace::log2_sweep(const ScanBlock& block) const noexcept {
  return std::min(block.log2_cells[0], row_bits(board_));
}

std::uint64_t CamSpace::clocks_of(const ScanBlock& block) const noexcept {
  const Sweeps sweeps = sweeps_of(block, log2_sweep(block));
  const std::uint64_t refreshes =
      std::uint64_t{sweeps.count / sweeps.between_refreshes} * sweeps.refreshes;
  return std::uint64_t{sweeps.count} * sweeps.clocks + refreshes * wire::kClocksPerRefresh;
}

Result<std::vector<ScanBlock>> CamSpace::blocks_around(const CamBox& box,
                                                       std::uint64_t clocks_a_byte) const {
  const std::uint64_t other_block_clocks = kOtherBlock_clocks + kOtherBlock_bytes * clocks_a_byte;
  std::array<std::vector<Parts>, 3> ways;
  for (std::size_t axis = 0; axis < ways.size(); ++axis) {
    const int length = 1 << (sector_[axis] + log2_parts_[axis]);
    const bool is_within = box.first[axis] >= 0 && box.first[axis] < length;
    if (!is_within || box.cells[axis] < 1 || box.cells[axis] > length) {
      return fail(Errc::InvalidArgument, "no box of " + std::to_string(box.cells[axis]) +
                                             " cells from cell " + std::to_string(box.first[axis]) +
                                             " on lies in a space that has " +
                                             std::to_string(length) + " along that axis");
    }
    ways[axis] = ways_to_have(box.first[axis], box.cells[axis], sector_[axis]);
  }
  std::vector<ScanBlock> best{whole()};
  std::uint64_t least = clocks_of(whole());
  for (const Parts& z : ways[2]) {
    for (const Parts& y : ways[1]) {
      for (const Parts& x : ways[0]) {
        std::vector<ScanBlock> blocks = all_of({&x, &y, &z});
        std::uint64_t clocks = 0;
        for (const ScanBlock& block : blocks) clocks += clocks_of(block) + other_block_clocks;
        if (clocks >= least) continue;
        least = clocks;
        best = std::move(blocks);
      }
    }
  }
  return best;
}

RegisterWords CamSpace::scan_format(const ScanBlock& block) const {
  RegisterWords words = default_words(Register::ScanFormat);
  const int sweep = log2_sweep(block);
  const Sweeps sweeps = sweeps_of(block, sweep);
  // Stretches that are a row of x close in themselves; parts of one do not.
  const std::uint32_t mode = sweep < sector_[0] ? 2 : 3;
  const Axes& log2 = block.log2_cells;
  words.set(field::kScanMode, mode)
      .set(field::kEndOfScan, static_cast<std::uint32_t>(log2[0] + log2[1] + log2[2]))
      .set(field::kEndOfSweep, static_cast<std::uint32_t>(sweep))
      .set(field::kEndOfStretch, static_cast<std::uint32_t>(sweep))
      .set(field::kSweepsBetweenRefresh, sweeps.between_refreshes)
      .set(field::kRefreshLength, sweeps.refreshes)
      .set(field::kEventLength, kEventBits);
  return words;
}

RegisterWords CamSpace::scan_perm(const ScanBlock& block) const {
  RegisterWords words = default_words(Register::ScanPerm);
  std::uint32_t index_bit = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (int bit = 0; bit < sector_[axis]; ++bit) {
      const int of_axis = first_bit(axis) + bit;
      const auto& of_site = field::kScanPerm[static_cast<std::size_t>(of_axis)];
      const bool is_varying = bit < block.log2_cells[axis];
      const bool is_one = (block.first[axis] >> bit & 1) != 0;
      words.set(of_site, is_varying ? index_bit : is_one ? kConstant1 : kConstant0);
      if (is_varying) ++index_bit;
    }
  }
  for (int bit = log2_sector_sites(); bit < kAddressBits; ++bit) {
    words.set(field::kScanPerm[static_cast<std::size_t>(bit)], kConstant0);
  }
  return words;
}

}  // namespace thimble::cambus
