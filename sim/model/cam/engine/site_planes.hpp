#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sim/model/cam/engine/engine.hpp"
#include "sim/model/cam/engine/vector_kernels.hpp"

namespace thimble::sim::cam {

// The 16 layers of a space as planes of bits that do not move: a kick changes where a layer begins
// in its plane. Layers may share a plane, each with a beginning of its own. Two bytes a site for
// the planes in use, and at most as much again for those that a step is writing.
//
// Thread: one at a time. Errors: none; layers, planes and blocks that are not there are mistakes of
// the caller.
class SitePlanes {
 public:
  using Plane = std::size_t;

  SitePlanes(const SiteSpace& space, const VectorKernels& kernels);

  [[nodiscard]] const SiteSpace& space() const noexcept { return space_; }
  [[nodiscard]] std::size_t blocks() const noexcept { return blocks_; }
  // Words of a block that have sites: fewer than all only where the space is smaller than a block.
  [[nodiscard]] std::size_t words_of_block() const noexcept { return words_of_block_; }

  void kick(std::span<const PlaneKick> kicks);
  // A plane that no layer has, until the layers are shown others. Its words are anything.
  [[nodiscard]] Plane claim();
  [[nodiscard]] Word* block_of(Plane plane, std::size_t block);
  // The layer's bits are in the plane from its first site on.
  void show(std::size_t layer, Plane plane);
  // Ends what claim() began: planes that no layer has are free again.
  void release_unused();

  // A block of a layer as it lies after its kicks: in its plane, or copied into `room` (of
  // kBlockWords). Valid until a step writes.
  [[nodiscard]] const Word* fetch(std::size_t layer, std::size_t block, Word* room) const;
  [[nodiscard]] std::uint64_t population(std::size_t layer);
  // Of a plane that was just written, by whom wrote it.
  void note_population(Plane plane, std::uint64_t ones) { planes_[plane].ones = ones; }

 private:
  struct alignas(64) Line {
    std::array<Word, 8> words;
  };
  struct Storage {
    std::vector<Line> lines{};
    bool is_used{false};
    std::optional<std::uint64_t> ones{};
  };
  struct Layer {
    Plane plane{0};
    std::array<std::uint32_t, 3> begin{};  // the site of the plane that is the layer's (0, 0, 0)
  };
  [[nodiscard]] const Word* words_of(Plane plane) const noexcept;
  [[nodiscard]] std::size_t source_row(const Layer& layer, std::size_t row) const noexcept;
  [[nodiscard]] const Word* gather_rows(const Layer& layer, std::size_t block, Word* room) const;
  void fetch_long_rows(const Layer& layer, std::size_t block, Word* room) const;
  void fetch_parts_of_words(const Layer& layer, std::size_t block, Word* room) const;

  SiteSpace space_;
  const VectorKernels* kernels_;
  std::size_t blocks_;
  std::size_t words_of_block_;
  std::array<Storage, 2 * kPlanes> planes_{};
  std::array<Layer, kPlanes> layers_{};
};

}  // namespace thimble::sim::cam
