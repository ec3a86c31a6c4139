#include "daemon/link/link_counters.hpp"

#include <numeric>

namespace thimble::link {

std::string_view to_string(RejectReason reason) noexcept {
  switch (reason) {
    case RejectReason::WrongSize:
      return "wrong size";
    case RejectReason::WrongPeer:
      return "wrong peer";
    case RejectReason::NonFinite:
      return "non-finite";
    case RejectReason::OutOfRange:
      return "out of range";
    case RejectReason::BadDirection:
      return "bad direction";
    case RejectReason::SessionRefused:
      return "session refused";
  }
  return "unknown";
}

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
