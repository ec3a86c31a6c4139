#include "daemon/world/cam/piece_layout.hpp"

#include <algorithm>
#include <cstdlib>
#include <random>
#include <string>

namespace thimble::world::cam {
namespace {

constexpr int kMostTries = 400;

struct Box {
  CamAxes from{};
  CamAxes size{};
};

class Layouter {
 public:
  Layouter(const CamGeometry& space, int pieces, std::uint64_t seed)
      : space_(space), cells_(cells_along(space)), layout_(space.cells()), random_(seed) {
    // So that the pieces fill some third of the space.
    int across = 1;
    while (across * across < 3 * pieces) ++across;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      least_[axis] = std::min(kLeastThickness_cells, cells_[axis]);
      most_[axis] = std::max(least_[axis], cells_[axis] / across);
    }
  }

  [[nodiscard]] bool place(int part) {
    for (int i = 0; i < kMostTries; ++i) {
      const Box first = box();
      if (!is_free(first)) continue;
      fill(first, part);
      // The second begins within the first, so the piece is one.
      Box second = box();
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const int room =
            std::min(first.size[axis], cells_[axis] - second.size[axis] + 1 - first.from[axis]);
        second.from[axis] = first.from[axis] + (room > 0 ? below(room) : 0);
      }
      if (fits(second) && is_free(second, part)) fill(second, part);
      return true;
    }
    return false;
  }
  [[nodiscard]] PieceLayout take() { return std::move(layout_); }

 private:
  [[nodiscard]] int below(int count) {
    return static_cast<int>(random_() % static_cast<std::uint64_t>(count));
  }
  [[nodiscard]] Box box() {
    Box box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.size[axis] = least_[axis] + below(most_[axis] - least_[axis] + 1);
      box.from[axis] = below(cells_[axis] - box.size[axis] + 1);
    }
    return box;
  }
  [[nodiscard]] bool fits(const Box& box) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (box.from[axis] + box.size[axis] > cells_[axis]) return false;
    }
    return true;
  }
  // With one cell around it, which the space's edges end; `part` is no obstacle to itself.
  [[nodiscard]] bool is_free(const Box& box, int part = 0) const {
    CamAxes from{};
    CamAxes end{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      from[axis] = std::max(box.from[axis] - 1, 0);
      end[axis] = std::min(box.from[axis] + box.size[axis] + 1, cells_[axis]);
    }
    CamAxes at{};
    for (at[2] = from[2]; at[2] < end[2]; ++at[2]) {
      for (at[1] = from[1]; at[1] < end[1]; ++at[1]) {
        for (at[0] = from[0]; at[0] < end[0]; ++at[0]) {
          const int there = layout_[index_of(space_, at)];
          if ((there != 0 && there != part) || is_middle(at)) return false;
        }
      }
    }
    return true;
  }
  [[nodiscard]] bool is_middle(const CamAxes& at) const {
    return at[0] == cells_[0] / 2 && at[1] == cells_[1] / 2 && at[2] == cells_[2] / 2;
  }
  void fill(const Box& box, int part) {
    CamAxes at{};
    for (at[2] = box.from[2]; at[2] < box.from[2] + box.size[2]; ++at[2]) {
      for (at[1] = box.from[1]; at[1] < box.from[1] + box.size[1]; ++at[1]) {
        for (at[0] = box.from[0]; at[0] < box.from[0] + box.size[0]; ++at[0]) {
          layout_[index_of(space_, at)] = static_cast<std::uint8_t>(part);
        }
      }
    }
  }

  CamGeometry space_;
  CamAxes cells_;
  CamAxes least_{};
  CamAxes most_{};
  PieceLayout layout_;
  std::mt19937_64 random_;
};

struct Arc {
  int first{0};
  int cells{1};
};

// What is used of a ring of `length` places from `at` on, but for its longest gap.
[[nodiscard]] Arc used_arc(const std::vector<bool>& is_used, std::size_t at, std::size_t length) {
  Arc arc{0, static_cast<int>(length)};
  std::size_t gap = 0;
  std::size_t longest = 0;
  for (std::size_t i = 0; i < 2 * length; ++i) {
    gap = is_used[at + i % length] ? 0 : gap + 1;
    if (gap <= longest || gap >= length) continue;
    longest = gap;
    arc = {static_cast<int>((i + 1) % length), static_cast<int>(length - gap)};
  }
  return arc;
}

}  // namespace

CamAxes cells_along(const CamGeometry& space) noexcept {
  return {1 << space.log2_cells[0], 1 << space.log2_cells[1], 1 << space.log2_cells[2]};
}

std::size_t index_of(const CamGeometry& space, const CamAxes& cell) noexcept {
  const int row = cell[1] + (cell[2] << space.log2_cells[1]);
  const int index = cell[0] + (row << space.log2_cells[0]);
  return static_cast<std::size_t>(index);
}

PieceSizes sizes_of(const PieceLayout& layout) noexcept {
  PieceSizes sizes{};
  for (const std::uint8_t part : layout) ++sizes[std::min<std::size_t>(part, kMostPieces)];
  return sizes;
}

CamBox moved_by(const CamGeometry& space, CamBox box, const CamAxes& cells) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.first[axis] = (box.first[axis] + cells[axis]) & ((1 << space.log2_cells[axis]) - 1);
  }
  return box;
}

CamBox swept_by(const CamGeometry& space, CamBox box, const CamAxes& cells) noexcept {
  CamAxes back{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    back[axis] = std::min(cells[axis], 0);
    const int length = 1 << space.log2_cells[axis];
    const int more = std::min(std::abs(cells[axis]), length);
    box.cells[axis] = std::min(box.cells[axis] + more, length);
  }
  return moved_by(space, box, back);
}

PieceBoxes boxes_of(const CamGeometry& space, const PieceLayout& layout) {
  PieceBoxes boxes{};
  const CamAxes cells = cells_along(space);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto length = static_cast<std::size_t>(cells[axis]);
    std::vector<bool> is_used(boxes.size() * length);  // by part, then by place along the axis
    std::size_t stride = 1;
    for (std::size_t before = 0; before < axis; ++before) {
      stride *= static_cast<std::size_t>(cells[before]);
    }
    for (std::size_t i = 0; i < layout.size(); ++i) {
      const std::size_t part = std::min<std::size_t>(layout[i], kMostPieces);
      is_used[part * length + i / stride % length] = true;
    }
    for (std::size_t part = 1; part < boxes.size(); ++part) {
      const auto arc = used_arc(is_used, part * length, length);
      boxes[part].first[axis] = arc.first;
      boxes[part].cells[axis] = arc.cells;
    }
  }
  return boxes;
}

Result<PieceLayout> random_layout(const CamGeometry& space, int pieces, std::uint64_t seed) {
  if (pieces < 0 || pieces > kMostPieces) {
    return fail(Errc::InvalidArgument, "pieces: there are 0 to " + std::to_string(kMostPieces));
  }
  Layouter layouter(space, std::max(pieces, 1), seed);
  for (int part = 1; part <= pieces; ++part) {
    if (layouter.place(part)) continue;
    return fail(Errc::InvalidArgument,
                "pieces: the space has room for " + std::to_string(part - 1) + " of them");
  }
  return layouter.take();
}

}  // namespace thimble::world::cam
