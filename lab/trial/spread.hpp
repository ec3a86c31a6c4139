#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace thimble::lab {

// What a sample of numbers is like, without keeping it. Without one all is 0. SOURCE of the running
// mean and variance: Welford 1962.
class Spread {
 public:
  void add(double value) noexcept {
    ++count_;
    const double before = value - mean_;
    mean_ += before / static_cast<double>(count_);
    squares_ += before * (value - mean_);
    least_ = count_ == 1 ? value : std::min(least_, value);
    most_ = count_ == 1 ? value : std::max(most_, value);
  }
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] double mean() const noexcept { return mean_; }
  // Standard deviation, of the population from which the sample is.
  [[nodiscard]] double deviation() const noexcept {
    return count_ < 2 ? 0 : std::sqrt(squares_ / static_cast<double>(count_ - 1));
  }
  [[nodiscard]] double least() const noexcept { return least_; }
  [[nodiscard]] double most() const noexcept { return most_; }

 private:
  std::uint64_t count_{0};
  double mean_{0};
  double squares_{0};
  double least_{0};
  double most_{0};
};

}  // namespace thimble::lab
