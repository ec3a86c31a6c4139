#include "daemon/link/link_counters.hpp"

#include <numeric>

namespace thimble::link {

std::uint64_t LinkCounters::rejected() const noexcept {
  return std::accumulate(rejected_by_reason.begin(), rejected_by_reason.end(), std::uint64_t{0});
}

ImpairmentCounters sum(const ImpairmentCounters& a, const ImpairmentCounters& b) noexcept {
  return {.lost = a.lost + b.lost,
          .duplicated = a.duplicated + b.duplicated,
          .reordered = a.reordered + b.reordered,
          .overflowed = a.overflowed + b.overflowed};
}

}  // namespace thimble::link
