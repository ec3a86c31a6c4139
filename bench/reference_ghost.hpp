#pragma once

#include <cstddef>
#include <vector>

// A point that follows a hand through a box of bits, one axis after the other, in plain code
// without headers of the project: the simplest thing that stops at walls. It tunnels through
// diagonal gaps and slides by the order of its axes, which the product's must not.
class ReferenceGhost {
 public:
  ReferenceGhost(int cells, double edge_m);

  void step(const double (&hand_m)[3]) noexcept;
  double position_m(int axis) const noexcept { return position_m_[axis]; }

 private:
  bool is_solid(const int (&cell)[3]) const noexcept;

  int cells_;
  double cell_m_;
  std::vector<bool> solid_;
  double position_m_[3]{};
  int cell_[3];
};
