#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "drivers/cambus/cambus_registers.hpp"
#include "sim/model/cam/engine/vector_kernels.hpp"

namespace thimble::sim::cam {

// Sites come in words of 64 whose addresses differ in their lowest six bits only; a word is named
// by the first of them. At most a block of words.
struct SiteWords {
  std::span<const std::uint32_t> words{};
  bool are_aligned{false};  // one behind the other, from a multiple of their length on
};

// Adds addresses whose numbers end at `tops`, the last bit of each: 24 bits, carries stop there.
[[nodiscard]] constexpr std::uint32_t add_within(std::uint32_t a, std::uint32_t b,
                                                 std::uint32_t tops) noexcept {
  return ((a & ~tops) + (b & ~tops)) ^ ((a ^ b) & tops);
}

// Where the sites of a layer are: at their address plus `offset`.
struct Placement {
  Placement() = default;
  // An offset and cuts as in their registers; a DRAM of 2^log2_sites.
  Placement(std::uint32_t by, std::uint32_t cuts, int log2_sites);

  [[nodiscard]] std::uint32_t address(std::uint32_t site) const noexcept {
    return add_within(site, offset, tops) & last;
  }
  // Of a row that is a word long at least.
  [[nodiscard]] std::size_t row_words() const noexcept { return (row + 1) / kWordSites; }
  // Of such a row: the address one word on, around its end.
  [[nodiscard]] std::uint32_t next_word(std::uint32_t address) const noexcept {
    return (address & ~row) | ((address + static_cast<std::uint32_t>(kWordSites)) & row);
  }

  std::uint32_t offset{0};
  std::uint32_t tops{0};
  std::uint32_t last{0};
  std::uint32_t row{0};  // the sites of a row less one: an offset turns each row in itself
};

// How many more ones than before, in the two halves of a DRAM.
using HalfCounts = std::array<std::int64_t, 2>;

// The DRAM of one module as 16 planes of bits, by physical address.
// Thread: one at a time. Errors: none; addresses beyond the DRAM are mistakes of the caller.
class PlaneDram {
 public:
  // SOURCE: ours; two halves of a word each.
  static constexpr int kMinLog2Sites = 7;

  PlaneDram(std::size_t sites, const VectorKernels& kernels);
  void take(std::span<const std::uint16_t> dram);
  void give(std::span<std::uint16_t> dram) const;

  // A layer's words of these sites: where they are, when they are a whole block there, or copied
  // into `room` (of kBlockWords).
  [[nodiscard]] const Word* fetch(std::size_t layer, const Placement& placement,
                                  const SiteWords& sites, Word* room) const;
  // `old` is what fetch() found. Adds to `counts`.
  void store(std::size_t layer, const Placement& placement, const SiteWords& sites, const Word* old,
             const Word* words, HalfCounts& counts);

 private:
  [[nodiscard]] std::size_t half_of(std::uint32_t address) const noexcept {
    return address >= sites_ / 2 ? 1 : 0;
  }
  static void fetch_rows(const Word* plane, const Placement& placement,
                         std::span<const std::uint32_t> words, Word* room);
  void store_long_rows(Word* plane, const Placement& placement, const SiteWords& sites,
                       const Word* old, const Word* words, HalfCounts& counts) const;
  void store_short_rows(Word* plane, const Placement& placement, const SiteWords& sites,
                        const Word* words, HalfCounts& counts) const;
  void put(Word* plane, std::size_t word, Word bits, Word mask, HalfCounts& counts) const;

  std::size_t sites_;
  const VectorKernels* kernels_;
  std::array<std::vector<Word>, cambus::kLayers> planes_{};
};

}  // namespace thimble::sim::cam
