#include "sim/model/cam/plane_dram.hpp"

#include <algorithm>
#include <bit>

namespace thimble::sim::cam {
namespace {

constexpr std::uint32_t kInWord = kWordSites - 1;
constexpr std::uint32_t kHighestBit = 1U << (cambus::kAddressBits - 1);

struct alignas(64) SiteBlock {
  std::array<std::uint16_t, kBlockSites> sites{};
};

bool lie_in_a_row(const Placement& placement, const SiteWords& sites) {
  const std::size_t length = sites.words.size() * kWordSites;
  return sites.are_aligned && (placement.offset & (length - 1)) == 0;
}

// Of rows that are shorter than a word: calls `each` with the first bit of a row within the word
// and the address of its first site.
template <typename Each>
void for_each_row(const Placement& placement, std::uint32_t word, const Each& each) {
  for (std::uint32_t at = 0; at < kWordSites; at += placement.row + 1) {
    each(at, placement.address(word + at) & ~placement.row);
  }
}

}  // namespace

Placement::Placement(std::uint32_t by, std::uint32_t cuts, int log2_sites)
    : offset(by), tops(cuts | kHighestBit), last((1U << log2_sites) - 1U) {
  const std::uint32_t first_top = tops & (~tops + 1U);
  row = (2 * first_top - 1) & last;
}

PlaneDram::PlaneDram(std::size_t sites, const VectorKernels& kernels)
    : sites_(sites), kernels_(&kernels) {
  const std::size_t blocks = (sites + kBlockSites - 1) / kBlockSites;
  for (auto& plane : planes_) plane.resize(blocks * kBlockWords);
}

void PlaneDram::take(std::span<const std::uint16_t> dram) {
  SiteBlock block;
  std::array<Word*, kPlanes> out{};
  for (std::size_t at = 0; at < dram.size(); at += kBlockSites) {
    std::copy_n(dram.begin() + static_cast<std::ptrdiff_t>(at),
                std::min(kBlockSites, dram.size() - at), block.sites.begin());
    for (std::size_t layer = 0; layer < kPlanes; ++layer) {
      out[layer] = planes_[layer].data() + at / kWordSites;
    }
    kernels_->from_sites(block.sites.data(), out.data());
  }
}

void PlaneDram::give(std::span<std::uint16_t> dram) const {
  SiteBlock block;
  std::array<const Word*, kPlanes> in{};
  for (std::size_t at = 0; at < dram.size(); at += kBlockSites) {
    for (std::size_t layer = 0; layer < kPlanes; ++layer) {
      in[layer] = planes_[layer].data() + at / kWordSites;
    }
    kernels_->to_sites(in.data(), block.sites.data());
    std::copy_n(block.sites.begin(), std::min(kBlockSites, dram.size() - at),
                dram.begin() + static_cast<std::ptrdiff_t>(at));
  }
}

const Word* PlaneDram::fetch(std::size_t layer, const Placement& placement, const SiteWords& sites,
                             Word* room) const {
  const Word* const plane = planes_[layer].data();
  const auto& words = sites.words;
  if (words.size() == kBlockWords && lie_in_a_row(placement, sites)) {
    return plane + placement.address(words.front()) / kWordSites;
  }
  if (placement.row < kInWord) {
    const Word mask = (Word{2} << placement.row) - 1;
    const unsigned turn = placement.offset & placement.row;
    for (std::size_t k = 0; k < words.size(); ++k) {
      room[k] = 0;
      for_each_row(placement, words[k], [&](std::uint32_t at, std::uint32_t address) {
        const Word bits = plane[address / kWordSites] >> (address & kInWord) & mask;
        room[k] |= ((bits >> turn | bits << (placement.row + 1 - turn)) & mask) << at;
      });
    }
    return room;
  }
  if (sites.are_aligned && placement.row_words() <= words.size()) {
    fetch_rows(plane, placement, words, room);
    return room;
  }
  const unsigned shift = placement.offset & kInWord;
  for (std::size_t k = 0; k < words.size(); ++k) {
    const std::uint32_t address = placement.address(words[k]);
    const Word low = plane[address / kWordSites];
    const std::uint32_t next = placement.next_word(address);
    room[k] = shift == 0 ? low : low >> shift | plane[next / kWordSites] << (kWordSites - shift);
  }
  return room;
}

// Whole rows: only the first word of each has its address worked out.
void PlaneDram::fetch_rows(const Word* plane, const Placement& placement,
                           std::span<const std::uint32_t> words, Word* room) {
  const unsigned shift = placement.offset & kInWord;
  const std::size_t row_words = placement.row_words();
  for (std::size_t first = 0; first < words.size(); first += row_words) {
    const std::uint32_t address = placement.address(words[first]);
    const Word* const row = plane + (address & ~placement.row) / kWordSites;
    std::size_t at = (address & placement.row) / kWordSites;
    for (std::size_t k = 0; k < row_words; ++k) {
      const std::size_t next = (at + 1) & (row_words - 1);
      room[first + k] = shift == 0 ? row[at] : row[at] >> shift | row[next] << (kWordSites - shift);
      at = next;
    }
  }
}

void PlaneDram::store(std::size_t layer, const Placement& placement, const SiteWords& sites,
                      const Word* old, const Word* words, HalfCounts& counts) {
  Word* const plane = planes_[layer].data();
  const std::size_t size = sites.words.size();
  if (std::equal(words, words + size, old)) return;
  if (lie_in_a_row(placement, sites) && size * kWordSites <= sites_ / 2) {
    const std::uint32_t address = placement.address(sites.words.front());
    const auto more = static_cast<std::int64_t>(kernels_->count_ones(words, size)) -
                      static_cast<std::int64_t>(kernels_->count_ones(old, size));
    counts[half_of(address)] += more;
    std::copy_n(words, size, plane + address / kWordSites);
  } else if (placement.row >= kInWord && placement.row < placement.last) {
    store_long_rows(plane, placement, sites, old, words, counts);
  } else {
    store_short_rows(plane, placement, sites, words, counts);
  }
}

// Each row is in one half: runs of words that are in the same are counted at once.
void PlaneDram::store_long_rows(Word* plane, const Placement& placement, const SiteWords& sites,
                                const Word* old, const Word* words, HalfCounts& counts) const {
  const unsigned shift = placement.offset & kInWord;
  const Word low_bits = ~(~Word{0} << shift);
  std::size_t first = 0;
  std::size_t half = half_of(placement.address(sites.words.front()));
  const auto count_until = [&](std::size_t end) {
    counts[half] += static_cast<std::int64_t>(kernels_->count_ones(words + first, end - first)) -
                    static_cast<std::int64_t>(kernels_->count_ones(old + first, end - first));
    first = end;
  };
  for (std::size_t k = 0; k < sites.words.size(); ++k) {
    const std::uint32_t address = placement.address(sites.words[k]);
    if (half_of(address) != half) {
      count_until(k);
      half = half_of(address);
    }
    Word& low = plane[address / kWordSites];
    low = (low & low_bits) | words[k] << shift;
    if (shift == 0) continue;
    Word& high = plane[placement.next_word(address) / kWordSites];
    high = (high & ~low_bits) | words[k] >> (kWordSites - shift);
  }
  count_until(sites.words.size());
}

// Several rows to a word, or one as long as the DRAM: nobody needs these to be fast.
void PlaneDram::store_short_rows(Word* plane, const Placement& placement, const SiteWords& sites,
                                 const Word* words, HalfCounts& counts) const {
  if (placement.row < kInWord) {
    const Word mask = (Word{2} << placement.row) - 1;
    const unsigned turn = placement.offset & placement.row;
    for (std::size_t k = 0; k < sites.words.size(); ++k) {
      for_each_row(placement, sites.words[k], [&](std::uint32_t at, std::uint32_t address) {
        const Word bits = words[k] >> at & mask;
        const Word turned = (bits << turn | bits >> (placement.row + 1 - turn)) & mask;
        const std::uint32_t first = address & kInWord;
        put(plane, address / kWordSites, turned << first, mask << first, counts);
      });
    }
    return;
  }
  const unsigned shift = placement.offset & kInWord;
  for (std::size_t k = 0; k < sites.words.size(); ++k) {
    const std::uint32_t address = placement.address(sites.words[k]);
    put(plane, address / kWordSites, words[k] << shift, ~Word{0} << shift, counts);
    if (shift == 0) continue;
    put(plane, placement.next_word(address) / kWordSites, words[k] >> (kWordSites - shift),
        ~(~Word{0} << shift), counts);
  }
}

void PlaneDram::put(Word* plane, std::size_t word, Word bits, Word mask, HalfCounts& counts) const {
  const Word old = plane[word];
  const Word now = (old & ~mask) | (bits & mask);
  plane[word] = now;
  counts[half_of(static_cast<std::uint32_t>(word * kWordSites))] +=
      std::popcount(now) - std::popcount(old);
}

}  // namespace thimble::sim::cam
