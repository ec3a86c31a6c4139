#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

namespace thimble::lab {

// Least squares of z = a + slope·x + other·y, without keeping the points. Units: those of the
// points.
class PlaneFit {
 public:
  void add(double x, double y, double z) noexcept {
    ++count_;
    const double n = static_cast<double>(count_);
    const double dx = x - x_;
    const double dy = y - y_;
    const double dz = z - z_;
    x_ += dx / n;
    y_ += dy / n;
    z_ += dz / n;
    xx_ += dx * (x - x_);
    xy_ += dx * (y - y_);
    yy_ += dy * (y - y_);
    xz_ += dx * (z - z_);
    yz_ += dy * (z - z_);
  }
  // NaN where the points do not tell it.
  [[nodiscard]] double slope() const noexcept {
    const double determinant = xx_ * yy_ - xy_ * xy_;
    if (!(determinant > 1e-9 * xx_ * yy_)) return std::numeric_limits<double>::quiet_NaN();
    return (xz_ * yy_ - yz_ * xy_) / determinant;
  }
  // Root mean square distance of the x from their mean.
  [[nodiscard]] double spread() const noexcept {
    return count_ == 0 ? 0 : std::sqrt(xx_ / static_cast<double>(count_));
  }

 private:
  std::uint64_t count_{0};
  double x_{0}, y_{0}, z_{0};
  double xx_{0}, xy_{0}, yy_{0}, xz_{0}, yz_{0};
};

}  // namespace thimble::lab
