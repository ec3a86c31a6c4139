#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/config/config.hpp"
#include "daemon/coupling/world_coupling.hpp"
#include "daemon/devices/device_executor.hpp"
#include "daemon/link/link_counters.hpp"
#include "daemon/link/thimble_messages.hpp"
#include "daemon/session/arm_rig.hpp"
#include "daemon/session/board_search.hpp"
#include "daemon/session/listener.hpp"
#include "daemon/session/made_world.hpp"
#include "daemon/world/edit_queue.hpp"
#include "daemon/world/world.hpp"
#include "hal/base/result.hpp"

namespace thimble::session {

// A world of the configuration, and the listener that offers it to arms of other hosts where
// it has one.
//
// Thread: the net plane's one thread. Ownership: must outlive the links into the world.
class WorldHost {
 public:
  // Between slices of edits. Ours: the period of the servo's default, so that links and clients
  // have most of the net plane's time whoever wakes it.
  static constexpr Duration kEditPace = std::chrono::milliseconds(1);

  // Errors: the source cannot be loaded, or the address not bound; named by world.
  [[nodiscard]] static Result<std::unique_ptr<WorldHost>> create(const config::WorldConfig& world,
                                                                 const RigParts& parts);
  ~WorldHost();

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] world::World& world() noexcept { return *world_; }
  [[nodiscard]] const world::World& world() const noexcept { return *world_; }
  // What answers one arm in this world, which must outlive it; sessions are numbered from
  // `first_session` up. Errors: as coupling::make_world_coupling(), make_own_world_half().
  [[nodiscard]] Result<std::unique_ptr<coupling::WorldCoupling>> make_world_half(
      const config::CouplingConfig& arm, std::uint32_t first_session);
  // Edits of its cells; they wait for their turn. The number of the batch. Errors: Unsupported
  // where nothing can be edited, else as EditQueue::submit(); named by world.
  [[nodiscard]] Result<std::uint64_t> submit_edits(std::vector<world::CellEdit> edits);
  // Its cells as an NRRD volume of bytes: 1 where there is matter (nrrd_of_grid()); of pieces their
  // numbers, as they were when somebody looked last. Errors: Unsupported where there are none.
  // Ours: as many as pieces may have; a millisecond or two of the world's thread.
  static constexpr std::size_t kMostShownCells = std::size_t{1} << 18;
  [[nodiscard]] Result<std::string> cells();
  // The state of a world that runs by itself, as a file; and one put back: how many steps it had
  // taken. Errors: Unsupported where it does not run, else as parse_state() and LiveWorld::load();
  // named by world.
  [[nodiscard]] Result<std::string> save_state();
  [[nodiscard]] Result<std::uint64_t> load_state(std::string_view bytes);
  // Where its edits wait; nullptr where there can be none.
  [[nodiscard]] world::EditQueue* edits() noexcept { return edits_ ? &*edits_ : nullptr; }
  [[nodiscard]] const world::EditQueue* edits() const noexcept {
    return edits_ ? &*edits_ : nullptr;
  }
  // One slice of them, no sooner than kEditPace after the last, however often it is called; of a
  // live world, the step that is due; of pieces on a board, what it has done meanwhile. Returns
  // when the next is due; none while none is.
  std::optional<MonotonicTime> pump(MonotonicTime now);
  // Where there are pieces to select and drop; nullptr where there are none.
  [[nodiscard]] world::cam::PieceWorld* pieces() noexcept { return world_->pieces(); }
  [[nodiscard]] const world::cam::PieceWorld* pieces() const noexcept { return world_->pieces(); }
  // The board of its pieces, to be pulled out; nullptr where it is on no simulated USB.
  [[nodiscard]] sim::cam::SimUsbCamBoard* usb_board() noexcept { return usb_board_.get(); }
  // Why nothing is felt of its board, with the world's name in front; empty when it works.
  [[nodiscard]] std::string trouble() const;
  // What somebody who touches it does not feel, though the configuration says it: a sentence.
  [[nodiscard]] const std::optional<std::string>& loss() const noexcept { return loss_; }
  // Nothing where the world does not listen.
  [[nodiscard]] std::optional<link::LinkStatus> listener_status() const;
  // Whether it listens at a serial line.
  [[nodiscard]] bool has_line() const noexcept;
  // Of each session of our own datagrams; they count in the listener's, too.
  [[nodiscard]] std::vector<link::LinkStatus> session_statuses() const;

 private:
  WorldHost();
  [[nodiscard]] Result<void> listen(const config::WorldConfig& said, const RigParts& parts);
  [[nodiscard]] BoardPlugs plugs_for(const config::WorldConfig& said, const RigParts& parts);
  std::optional<MonotonicTime> pump_edits(MonotonicTime now);
  [[nodiscard]] tl::unexpected<Error> does_not_run() const;
  // For an arm of another host that names its scheme. Errors: none such, or none that goes with
  // this world.
  [[nodiscard]] Result<std::unique_ptr<coupling::WorldCoupling>> make_half_for(
      const link::ThimbleHalf& half, bool has_materials, std::uint32_t first_session);

  std::string name_;
  config::ConstraintModel model_{config::ConstraintModel::GhostPoint};
  std::optional<std::string> loss_;
  devices::InlineExecutor inline_executor_;  // before the world, whose board it closes
  std::shared_ptr<sim::cam::SimUsbCamBoard> usb_board_;
  std::unique_ptr<world::World> world_;
  std::optional<world::EditQueue> edits_;
  std::optional<MonotonicTime> next_slice_;  // none: at once
  std::unique_ptr<coupling::WorldCoupling> half_of_1999_;
  std::unique_ptr<Listener> listener_;  // last: it uses the world
};

}  // namespace thimble::session
