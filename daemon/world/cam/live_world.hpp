#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/world/cam/automaton.hpp"
#include "daemon/world/voxel_world.hpp"
#include "daemon/world/world.hpp"
#include "hal/base/time.hpp"

namespace thimble::world::cam {

struct LiveSettings {
  double workspace_m{0.09};  // along the longest axis of the space; cells are cubes
  double steps_per_s{10};    // 0: it stands still
  double poke_cells{3};      // radius of what a button changes
  std::string source{};      // for messages
};

// A world that changes by itself while it is touched: the cells of an automaton that are matter
// (thesis 5.4.1). Cells that grow over a finger push it out as any that fill do; along an axis of a
// single cell nothing holds the hand. The space has walls, though the automaton may be a torus.
//
// What somebody changes of its cells (pokes, edits) is told the automaton before its next step.
//
// Thread: one, the world's. Not RT: pump() takes a step of the automaton; move_probe() never does.
class LiveWorld final : public World {
 public:
  // Errors: InvalidArgument for a workspace, pace or radius that is none, or fewer than 64 cells.
  [[nodiscard]] static Result<std::unique_ptr<LiveWorld>> create(
      LiveSettings settings, std::unique_ptr<Automaton> automaton);

  [[nodiscard]] const WorldInfo& info() const noexcept override { return info_; }
  // Of a space; what works on cells knows no free third axis.
  [[nodiscard]] const VoxelGrid* grid() const noexcept override {
    return is_plane_ ? nullptr : cells_.grid();
  }
  [[nodiscard]] const VoxelGrid* felt_cells() const noexcept override { return cells_.grid(); }
  [[nodiscard]] bool is_plane() const noexcept override { return is_plane_; }
  // The automaton marks it, after each step anew; what is edited in between is in every zone.
  void mark_zone(std::int32_t cells) override;
  [[nodiscard]] bool is_in_zone(Cell cell) const noexcept override;
  [[nodiscard]] std::size_t occupied_cells() const noexcept override {
    return cells_.occupied_cells();
  }
  [[nodiscard]] VoxelWorld* editable() noexcept override { return &cells_; }
  [[nodiscard]] LiveWorld* live() noexcept override { return this; }
  [[nodiscard]] std::uint32_t loads() const noexcept override { return loads_; }
  [[nodiscard]] Result<ProbeId> add_probe(Position3 hand) override;
  void remove_probe(ProbeId probe) noexcept override;
  // The first button takes the matter around the ghost point away, the second fills what is there.
  void press(ProbeId probe, std::uint32_t buttons) noexcept override;
  ProbeMotion move_probe(ProbeId probe, Position3 hand, Duration dt) noexcept override;

  // A step when one is due, and no more than one: what is late is left out. Returns when the next
  // is due; none where it stands still.
  std::optional<MonotonicTime> pump(MonotonicTime now);
  [[nodiscard]] std::uint64_t steps() const noexcept { return automaton_->steps(); }
  [[nodiscard]] std::uint64_t left_out() const noexcept { return left_out_; }

  [[nodiscard]] AutomatonState save();
  // Errors: as Automaton::load().
  [[nodiscard]] Result<void> load(const AutomatonState& state);

 private:
  LiveWorld(LiveSettings settings, std::unique_ptr<Automaton> automaton, VoxelGrid grid);
  [[nodiscard]] Position3 within(Position3 p) const noexcept;
  void tell_changes();
  void show();
  void mark();

  LiveSettings settings_;
  std::unique_ptr<Automaton> automaton_;
  VoxelWorld cells_;
  bool is_plane_;
  WorldInfo info_;
  std::vector<std::uint64_t> seen_;  // matter, as the automaton had it last
  std::vector<std::uint64_t> changed_;
  std::int32_t zone_cells_{0};                 // 0: nobody wants a zone
  std::vector<std::uint64_t> zone_;            // by cell, as of `zone_changes_`
  std::optional<std::uint64_t> zone_changes_;  // VoxelWorld::changes() when it was marked
  struct Finger {
    ProbeId probe{};
    Position3 ghost{};
  };
  std::vector<Finger> fingers_;  // where pokes go
  std::optional<MonotonicTime> next_step_;
  std::uint64_t left_out_{0};
  std::uint32_t loads_{0};
};

}  // namespace thimble::world::cam
