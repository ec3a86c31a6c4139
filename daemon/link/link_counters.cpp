#include "daemon/link/link_counters.hpp"

#include <numeric>

namespace thimble::link {

std::uint64_t LinkCounters::rejected() const noexcept {
  return std::accumulate(rejected_by_reason.begin(), rejected_by_reason.end(), std::uint64_t{0});
}

LinkCounters sum(const LinkCounters& a, const LinkCounters& b) noexcept {
  LinkCounters out{.sent = a.sent + b.sent,
                   .received = a.received + b.received,
                   .accepted = a.accepted + b.accepted,
                   .lost = a.lost + b.lost,
                   .stale = a.stale + b.stale,
                   .duplicated = a.duplicated + b.duplicated,
                   .reordered = a.reordered + b.reordered,
                   .withheld = a.withheld + b.withheld,
                   .timed_out = a.timed_out + b.timed_out,
                   .unencodable_planes = a.unencodable_planes + b.unencodable_planes,
                   .send_errors = a.send_errors + b.send_errors,
                   .receive_errors = a.receive_errors + b.receive_errors,
                   .sessions_opened = a.sessions_opened + b.sessions_opened,
                   .sessions_released = a.sessions_released + b.sessions_released,
                   .injected = sum(a.injected, b.injected)};
  for (std::size_t i = 0; i < kRejectReasons; ++i) {
    out.rejected_by_reason[i] = a.rejected_by_reason[i] + b.rejected_by_reason[i];
  }
  return out;
}

ImpairmentCounters sum(const ImpairmentCounters& a, const ImpairmentCounters& b) noexcept {
  return {.lost = a.lost + b.lost,
          .duplicated = a.duplicated + b.duplicated,
          .reordered = a.reordered + b.reordered,
          .overflowed = a.overflowed + b.overflowed};
}

}  // namespace thimble::link
