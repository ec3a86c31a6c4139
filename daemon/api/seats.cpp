#include "daemon/api/seats.hpp"

#include <map>
#include <utility>

namespace thimble::api {

std::optional<ClientId> who_goes(const std::vector<Seat>& seats, UserId newcomer) {
  std::map<UserId, std::size_t> counts{{newcomer, 1}};
  for (const Seat& seat : seats) {
    if (!seat.holds_lease) ++counts[seat.user];
  }
  const Seat* chosen = nullptr;
  const auto goes_before = [&](const Seat& left, const Seat& right) {
    const std::size_t of_left = counts[left.user];
    const std::size_t of_right = counts[right.user];
    return of_left != of_right ? of_left > of_right : left.moved < right.moved;
  };
  for (const Seat& seat : seats) {
    if (seat.holds_lease) continue;
    if (chosen == nullptr || goes_before(seat, *chosen)) chosen = &seat;
  }
  if (chosen == nullptr) return std::nullopt;
  return chosen->client;
}

}  // namespace thimble::api
