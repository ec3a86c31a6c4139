#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "daemon/session/world_host.hpp"
#include "tests/campaign/programme.hpp"

namespace thimble::campaign {

// A client of the API that edits the world: through the same queue, with requests that it takes.
// A world without cells has nothing to edit: then this does nothing.
//
// Thread: that of the world, which must outlive it. Errors: a request that is refused although it
// is a good one is a defect: std::logic_error. Where too much waits it is refused as it should be.
class Edits {
 public:
  explicit Edits(session::WorldHost& host) noexcept : host_(&host) {}

  // `hand`: where the finger is in the world; two of three edits are made about it.
  void begin(const Event& event, Position3 hand);
  void end(const Event& event);

  [[nodiscard]] std::uint64_t waiting() const noexcept;
  [[nodiscard]] std::uint64_t applied() const noexcept;
  // Some of them since the last call.
  [[nodiscard]] bool has_applied() noexcept;

 private:
  void submit(std::vector<world::CellEdit> edits);

  session::WorldHost* host_;
  std::vector<std::pair<const Event*, world::CellEdit>> lasting_;
  std::uint64_t applied_{0};
};

// The edit that an event stands for.
[[nodiscard]] world::CellEdit edit_of(const Event& event, const world::VoxelWorld& world,
                                      Position3 hand);
[[nodiscard]] std::size_t all_cells(const world::World& world) noexcept;

}  // namespace thimble::campaign
