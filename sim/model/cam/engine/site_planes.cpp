#include "sim/model/cam/engine/site_planes.hpp"

#include <algorithm>
#include <cstring>

#include "hal/base/check.hpp"

namespace thimble::sim::cam {
namespace {

constexpr int kLog2WordSites = 6;
static_assert(kWordSites == 1U << kLog2WordSites);

std::uint32_t mask_of(int log2) { return (1U << log2) - 1U; }

// `size` words of a row from word `first` on, around its end.
void copy_around(const Word* row, std::size_t row_words, std::size_t first, std::size_t size,
                 Word* out) {
  first &= row_words - 1;
  while (size > 0) {
    const std::size_t part = std::min(size, row_words - first);
    std::memcpy(out, row + first, part * sizeof(Word));
    out += part;
    size -= part;
    first = 0;
  }
}

}  // namespace

Result<void> check_space(const SiteSpace& space) {
  const auto is_axis = [](int log2) { return log2 >= 0 && log2 <= kMaxLog2SpaceSites; };
  const auto& axes = space.log2_cells;
  if (!std::all_of(axes.begin(), axes.end(), is_axis) || space.log2_sites() < kMinLog2SpaceSites ||
      space.log2_sites() > kMaxLog2SpaceSites) {
    return fail(Errc::InvalidArgument, "a space has 2^" + std::to_string(kMinLog2SpaceSites) +
                                           " to 2^" + std::to_string(kMaxLog2SpaceSites) +
                                           " sites");
  }
  return {};
}

SitePlanes::SitePlanes(const SiteSpace& space, const VectorKernels& kernels)
    : space_(space),
      kernels_(&kernels),
      blocks_((space.sites() + kBlockSites - 1) / kBlockSites),
      words_of_block_(std::min(space.sites(), kBlockSites) / kWordSites) {
  const Plane empty = claim();
  std::memset(block_of(empty, 0), 0, blocks_ * kBlockWords * sizeof(Word));
  for (std::size_t layer = 0; layer < kPlanes; ++layer) show(layer, empty);
}

void SitePlanes::kick(std::span<const PlaneKick> kicks) {
  std::array<std::array<int, 3>, kPlanes> by{};
  for (const PlaneKick& kick : kicks) {
    for (std::size_t layer = 0; layer < kPlanes; ++layer) {
      if ((kick.layers >> layer & 1) != 0) by[layer] = kick.cells;
    }
  }
  for (std::size_t layer = 0; layer < kPlanes; ++layer) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::uint32_t& begin = layers_[layer].begin[axis];
      begin =
          (begin - static_cast<std::uint32_t>(by[layer][axis])) & mask_of(space_.log2_cells[axis]);
    }
  }
}

SitePlanes::Plane SitePlanes::claim() {
  const auto found = std::find_if(planes_.begin(), planes_.end(),
                                  [](const Storage& storage) { return !storage.is_used; });
  THIMBLE_CHECK(found != planes_.end());
  found->is_used = true;
  found->ones.reset();
  found->lines.resize(blocks_ * kBlockWords / std::tuple_size_v<decltype(Line::words)>);
  return static_cast<Plane>(found - planes_.begin());
}

Word* SitePlanes::block_of(Plane plane, std::size_t block) {
  return planes_[plane].lines.front().words.data() + block * kBlockWords;
}

const Word* SitePlanes::words_of(Plane plane) const noexcept {
  return planes_[plane].lines.front().words.data();
}

void SitePlanes::show(std::size_t layer, Plane plane) { layers_[layer] = {plane, {}}; }

void SitePlanes::release_unused() {
  for (Storage& storage : planes_) storage.is_used = false;
  for (const Layer& layer : layers_) planes_[layer.plane].is_used = true;
}

std::uint64_t SitePlanes::population(std::size_t layer) {
  Storage& storage = planes_[layers_[layer].plane];
  if (!storage.ones) {
    storage.ones =
        kernels_->count_ones(words_of(layers_[layer].plane), space_.sites() / kWordSites);
  }
  return *storage.ones;
}

// Rows run along x; which row of the plane is the layer's.
std::size_t SitePlanes::source_row(const Layer& layer, std::size_t row) const noexcept {
  const int log2_y = space_.log2_cells[1];
  const std::size_t y = (row + layer.begin[1]) & mask_of(log2_y);
  const std::size_t z = ((row >> log2_y) + layer.begin[2]) & mask_of(space_.log2_cells[2]);
  return z << log2_y | y;
}

const Word* SitePlanes::fetch(std::size_t number, std::size_t block, Word* room) const {
  const Layer& layer = layers_[number];
  const auto& [x, y, z] = layer.begin;
  if (x == 0 && y == 0 && z == 0) return words_of(layer.plane) + block * kBlockWords;
  if (space_.log2_cells[0] < kLog2WordSites) {
    fetch_parts_of_words(layer, block, room);
    return room;
  }
  const std::size_t row_words = std::size_t{1} << (space_.log2_cells[0] - kLog2WordSites);
  if (row_words > kernels_->lanes) {
    fetch_long_rows(layer, block, room);
    return room;
  }
  const Word* const rows = gather_rows(layer, block, room);
  if (x == 0) return rows;
  kernels_->rotate_rows(rows, room, row_words, x / kWordSites, x % kWordSites);
  return room;
}

// Whole rows, as they come to lie; where they are one behind the other already, there.
const Word* SitePlanes::gather_rows(const Layer& layer, std::size_t block, Word* room) const {
  const int log2_row_words = space_.log2_cells[0] - kLog2WordSites;
  const std::size_t rows = words_of_block_ >> log2_row_words;
  const std::size_t y_rows = std::size_t{1} << space_.log2_cells[1];
  const Word* const words = words_of(layer.plane);
  for (std::size_t row = 0; row < rows;) {
    // As far as neither the layer's rows nor the plane's begin at y = 0 again.
    const std::size_t wanted = block * rows + row;
    const std::size_t source = source_row(layer, wanted);
    const std::size_t y = std::max(wanted & (y_rows - 1), source & (y_rows - 1));
    const std::size_t run = std::min(rows - row, y_rows - y);
    const Word* const from = words + (source << log2_row_words);
    if (run << log2_row_words == kBlockWords) return from;
    std::memcpy(room + (row << log2_row_words), from, (run << log2_row_words) * sizeof(Word));
    row += run;
  }
  return room;
}

// Rows, or parts of them, of more words than a vector has.
void SitePlanes::fetch_long_rows(const Layer& layer, std::size_t block, Word* room) const {
  const int log2_row_words = space_.log2_cells[0] - kLog2WordSites;
  const std::size_t row_words = std::size_t{1} << log2_row_words;
  const std::size_t part = std::min(row_words, words_of_block_);
  const std::size_t skipped = layer.begin[0] / kWordSites;
  const unsigned bits = layer.begin[0] % kWordSites;
  std::array<Word, kBlockWords + 1> around;
  for (std::size_t at = 0; at < words_of_block_; at += part) {
    const std::size_t word = block * kBlockWords + at;
    const Word* const row =
        words_of(layer.plane) + (source_row(layer, word >> log2_row_words) << log2_row_words);
    copy_around(row, row_words, (word & (row_words - 1)) + skipped, part + 1, around.data());
    if (bits == 0) {
      std::memcpy(room + at, around.data(), part * sizeof(Word));
    } else {
      kernels_->shift_words(around.data(), room + at, part, bits);
    }
  }
}

// Several rows to a word: one after the other. Nobody needs such a narrow space to be fast.
void SitePlanes::fetch_parts_of_words(const Layer& layer, std::size_t block, Word* room) const {
  const int log2_x = space_.log2_cells[0];
  const unsigned length = 1U << log2_x;
  const Word mask = (Word{1} << length) - 1;
  const std::size_t rows = words_of_block_ << (kLog2WordSites - log2_x);
  std::memset(room, 0, kBlockWords * sizeof(Word));
  for (std::size_t row = 0; row < rows; ++row) {
    const std::size_t from = source_row(layer, block * rows + row) << log2_x;
    const Word bits = words_of(layer.plane)[from / kWordSites] >> (from % kWordSites) & mask;
    const unsigned skipped = layer.begin[0];
    const Word turned = (bits >> skipped | bits << (length - skipped)) & mask;
    const std::size_t to = row << log2_x;
    room[to / kWordSites] |= turned << (to % kWordSites);
  }
}

}  // namespace thimble::sim::cam
