#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "daemon/api/commands.hpp"

namespace thimble::api {

using UserId = std::uint32_t;  // uid_t

// A connection that is open.
struct Seat {
  ClientId client{};
  UserId user{0};          // whose process made it
  std::uint64_t moved{0};  // the higher, the later: when it came, asked or was answered
  bool holds_lease{false};
};

// Who goes when a newcomer of `newcomer` finds all `seats` taken, the newcomer's counted among that
// user's: of the user who has most of those who hold no lease, the one that has been silent longest
// (docs/decisions/0406-a-newcomer-always-finds-a-seat.md). Nothing: all hold a lease. Pure.
[[nodiscard]] std::optional<ClientId> who_goes(const std::vector<Seat>& seats, UserId newcomer);

}  // namespace thimble::api
