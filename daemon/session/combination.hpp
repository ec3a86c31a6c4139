#pragma once

#include <optional>
#include <string>

#include "daemon/config/config.hpp"
#include "daemon/world/world.hpp"
#include "hal/base/result.hpp"

namespace thimble::session {

// Which worlds go with which schemes: the table of docs/worlds-and-schemes.md. Pure.

// What does not go together: the key that says so, below its arm or world, and the reason with what
// to use instead.
struct Refusal {
  std::string key;
  std::string reason;
};
[[nodiscard]] std::optional<Refusal> find_refusal(const world::World& world,
                                                  const config::WorldConfig& said);
[[nodiscard]] std::optional<Refusal> find_refusal(const world::World& world,
                                                  const config::CouplingConfig& arm);

// What "auto" means for an arm that touches `world`, which was made as said; any other word means
// itself.
[[nodiscard]] config::CouplingScheme choose_scheme(const world::World& world,
                                                   const config::WorldConfig& said,
                                                   const config::CouplingConfig& arm);

// Whether the datagrams of 1999 can say what is felt in it: they carry faces across the axes only,
// and cannot say that a board has fallen silent. Where not, a listener speaks our own alone.
[[nodiscard]] bool can_serve_1999(const world::World& world) noexcept;

// The same as a Result. Errors: Unsupported, "KEY: reason".
// What is said of the world itself: its constraint model, and whether it listens.
[[nodiscard]] Result<void> check_combination(const world::World& world,
                                             const config::WorldConfig& said);
// An arm that touches `world` in this process.
[[nodiscard]] Result<void> check_combination(const world::World& world,
                                             const config::CouplingConfig& arm);

// What goes together, though somebody who touches this world feels less than it says: words for the
// person who reads the log, or none.
[[nodiscard]] std::optional<std::string> find_loss(const config::WorldConfig& said);

}  // namespace thimble::session
