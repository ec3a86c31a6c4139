#include "bench/reference_ghost.hpp"

ReferenceGhost::ReferenceGhost(int cells, double edge_m)
    : cells_(cells), cell_m_(edge_m / cells), cell_{cells / 2, cells / 2, cells / 2} {
  const auto is_inner = [cells](int i) { return 6 * i + 3 > 2 * cells && 6 * i + 3 < 4 * cells; };
  for (int z = 0; z < cells; ++z) {
    for (int y = 0; y < cells; ++y) {
      for (int x = 0; x < cells; ++x) {
        solid_.push_back(!(is_inner(x) && is_inner(y) && is_inner(z)));
      }
    }
  }
}

bool ReferenceGhost::is_solid(const int (&cell)[3]) const noexcept {
  for (const int index : cell) {
    if (index < 0 || index >= cells_) return true;
  }
  const auto n = static_cast<std::size_t>(cells_);
  return solid_[static_cast<std::size_t>(cell[0]) +
                n * (static_cast<std::size_t>(cell[1]) + n * static_cast<std::size_t>(cell[2]))];
}

void ReferenceGhost::step(const double (&hand_m)[3]) noexcept {
  for (int axis = 0; axis < 3; ++axis) {
    const int way = hand_m[axis] > position_m_[axis] ? 1 : -1;
    for (;;) {
      const double face_m = (cell_[axis] + (way > 0) - 0.5 * cells_) * cell_m_;
      if ((hand_m[axis] - face_m) * way <= 0) {
        position_m_[axis] = hand_m[axis];
        break;
      }
      cell_[axis] += way;
      if (!is_solid(cell_)) continue;
      cell_[axis] -= way;
      position_m_[axis] = face_m;
      break;
    }
  }
}
