#pragma once

#include <cstddef>

#include "hal/base/geometry.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::sim {

// Three numbers of one kind, for the equations of motion, where a place, a torque and a rate take
// turns in the same line. The unit is that of the member holding it.
using Triple = Vector3<struct TripleTag>;

// Thread: any. RT: all. Errors: none; not finite in, not finite out.
[[nodiscard]] inline Triple row_of(const Matrix3& m, std::size_t row) noexcept {
  return {m.row[row][0], m.row[row][1], m.row[row][2]};
}
[[nodiscard]] inline Matrix3 matrix_of_rows(Triple a, Triple b, Triple c) noexcept {
  return {{{{a.x, a.y, a.z}, {b.x, b.y, b.z}, {c.x, c.y, c.z}}}};
}
[[nodiscard]] inline Triple each_times(Triple a, Triple b) noexcept {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
[[nodiscard]] inline Triple each_over(Triple a, Triple b) noexcept {
  return {a.x / b.x, a.y / b.y, a.z / b.z};
}
[[nodiscard]] inline Triple cross_product(Triple a, Triple b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// m v
[[nodiscard]] inline Triple times(const Matrix3& m, Triple v) noexcept {
  return {dot(row_of(m, 0), v), dot(row_of(m, 1), v), dot(row_of(m, 2), v)};
}
// m^T v
[[nodiscard]] inline Triple transposed_times(const Matrix3& m, Triple v) noexcept {
  return v.x * row_of(m, 0) + v.y * row_of(m, 1) + v.z * row_of(m, 2);
}
// m^T m
[[nodiscard]] inline Matrix3 square_of(const Matrix3& m) noexcept {
  const auto column = [&](std::size_t i) { return Triple{m.row[0][i], m.row[1][i], m.row[2][i]}; };
  const auto line = [&](Triple a) {
    return Triple{dot(a, column(0)), dot(a, column(1)), dot(a, column(2))};
  };
  return matrix_of_rows(line(column(0)), line(column(1)), line(column(2)));
}
[[nodiscard]] inline double determinant_of(const Matrix3& m) noexcept {
  return dot(row_of(m, 0), cross_product(row_of(m, 1), row_of(m, 2)));
}
// x of m x = v, by Cramer's rule; the determinant must not be 0.
[[nodiscard]] inline Triple solved(const Matrix3& m, Triple v) noexcept {
  const Triple a = row_of(m, 0);
  const Triple b = row_of(m, 1);
  const Triple c = row_of(m, 2);
  return (1 / determinant_of(m)) *
         (v.x * cross_product(b, c) + v.y * cross_product(c, a) + v.z * cross_product(a, b));
}
// `determinant`: that of m, not 0.
[[nodiscard]] inline Matrix3 inverse_of(const Matrix3& m, double determinant) noexcept {
  const Triple a = row_of(m, 0);
  const Triple b = row_of(m, 1);
  const Triple c = row_of(m, 2);
  const double scale = 1 / determinant;
  const Triple x = scale * cross_product(b, c);
  const Triple y = scale * cross_product(c, a);
  const Triple z = scale * cross_product(a, b);
  return {{{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}}};
}
// x of m^T x = v.
[[nodiscard]] inline Triple solved_transposed(const Matrix3& m, Triple v) noexcept {
  const Triple a = row_of(m, 0);
  const Triple b = row_of(m, 1);
  const Triple c = row_of(m, 2);
  return (1 / determinant_of(m)) * Triple{dot(v, cross_product(b, c)), dot(v, cross_product(c, a)),
                                          dot(v, cross_product(a, b))};
}

}  // namespace thimble::sim
