#include "daemon/world/plane_projection.hpp"

#include <algorithm>
#include <limits>

namespace thimble::world {
namespace {

// Squared sine of the least angle at which planes are told apart.
constexpr double kLeastDeterminant = 1e-9;
// Planes that are nearly parallel may be met no better than this; beyond it they contradict.
constexpr double kContradiction_m = 1e-6;

using Shares = std::array<double, kMaxContactPlanes>;
using Gram = std::array<std::array<double, kMaxContactPlanes>, kMaxContactPlanes>;

// Looks for the set of planes that holds the point.
class Search {
 public:
  explicit Search(const PastPlanes& planes) noexcept : planes_(planes) {
    for (std::size_t i = 0; i < planes.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        gram_[i][j] = gram_[j][i] = dot(planes[i].normal, planes[j].normal);
      }
      gram_[i][i] = 1;
    }
  }

  // Whether there is one; `best()` then.
  bool run() noexcept {
    const std::size_t count = planes_.size();
    for (std::size_t i = 0; i < count; ++i) {
      if (try_one(i)) return true;
    }
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = i + 1; j < count; ++j) {
        if (try_two(i, j)) return true;
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = i + 1; j < count; ++j) {
        for (std::size_t k = j + 1; k < count; ++k) {
          if (try_three(i, j, k)) return true;
        }
      }
    }
    return best_left_m_ <= kContradiction_m;
  }
  [[nodiscard]] const Shares& best() const noexcept { return best_; }

 private:
  bool try_one(std::size_t i) noexcept {
    const double past_m = planes_[i].past_m;
    if (!(past_m > 0)) return false;
    Shares shares{};
    shares[i] = past_m;
    return judge(shares);
  }

  bool try_two(std::size_t i, std::size_t j) noexcept {
    const double cosine = gram_[i][j];
    const double determinant = 1 - cosine * cosine;
    if (determinant < kLeastDeterminant) return false;
    Shares shares{};
    shares[i] = (planes_[i].past_m - cosine * planes_[j].past_m) / determinant;
    shares[j] = (planes_[j].past_m - cosine * planes_[i].past_m) / determinant;
    if (!(shares[i] > 0) || !(shares[j] > 0)) return false;
    return judge(shares);
  }

  // Cramer's rule on the symmetric matrix of cosines.
  bool try_three(std::size_t i, std::size_t j, std::size_t k) noexcept {
    const double a = gram_[i][j];
    const double b = gram_[i][k];
    const double c = gram_[j][k];
    const double determinant = 1 + 2 * a * b * c - a * a - b * b - c * c;
    if (determinant < kLeastDeterminant) return false;
    const double x = planes_[i].past_m;
    const double y = planes_[j].past_m;
    const double z = planes_[k].past_m;
    Shares shares{};
    shares[i] = ((1 - c * c) * x + (b * c - a) * y + (a * c - b) * z) / determinant;
    shares[j] = ((b * c - a) * x + (1 - b * b) * y + (a * b - c) * z) / determinant;
    shares[k] = ((a * c - b) * x + (a * b - c) * y + (1 - a * a) * z) / determinant;
    if (!(shares[i] > 0) || !(shares[j] > 0) || !(shares[k] > 0)) return false;
    return judge(shares);
  }

  // Whether the point that `shares` lead to is free; remembers the freest.
  bool judge(const Shares& shares) noexcept {
    double left_m = 0;
    for (std::size_t i = 0; i < planes_.size(); ++i) {
      double past_m = planes_[i].past_m;
      for (std::size_t j = 0; j < planes_.size(); ++j) past_m -= gram_[i][j] * shares[j];
      left_m = std::max(left_m, past_m);
    }
    if (left_m < best_left_m_) {
      best_left_m_ = left_m;
      best_ = shares;
    }
    return left_m <= kPlaneTolerance_m;
  }

  const PastPlanes& planes_;
  Gram gram_{};
  Shares best_{};
  double best_left_m_{std::numeric_limits<double>::infinity()};
};

}  // namespace

PlaneProjection project(const PastPlanes& planes) noexcept {
  PlaneProjection out;
  const bool is_free = std::none_of(planes.begin(), planes.end(),
                                    [](const PastPlane& plane) { return plane.past_m > 0; });
  if (is_free) return out;
  Search search(planes);
  out.has_place = search.run();
  for (std::size_t i = 0; i < planes.size(); ++i) {
    out.share[i] = out.has_place ? search.best()[i] : std::max(0.0, planes[i].past_m);
    out.past += along<DisplacementTag>(planes[i].normal, out.share[i]);
  }
  return out;
}

}  // namespace thimble::world
