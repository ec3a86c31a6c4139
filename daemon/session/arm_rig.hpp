#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "daemon/coupling/placed_link.hpp"
#include "daemon/session/arm_session.hpp"
#include "daemon/session/rig_link.hpp"
#include "daemon/session/sim_arm.hpp"
#include "daemon/session/stand_in.hpp"
#include "hal/bus/memory_window.hpp"
#include "sim/time/real_time_brake.hpp"

namespace thimble::session {

class WorldHost;

// What every arm of a process shares; all must outlive the rigs.
struct RigParts {
  const plugin::SimModelRegistry& models;
  const plugin::DriverRegistry& drivers;
  bus::BusEnumerator* real_buses{nullptr};  // nullptr: only "sim:" devices can be opened
  devices::ArmGuards* guards{nullptr};  // of real arms; nullptr: those that need one are refused
  // Opens and closes the real arm of that name while arms run; nothing: done at once.
  std::function<devices::DeviceExecutor&(const std::string& arm)> executor_for{};
  // The same for the board of the world of that name.
  std::function<devices::DeviceExecutor&(const std::string& world)> executor_for_board{};
  // The memory of the CAM board in a slot of this machine; nothing: there is no slot. May wait.
  std::function<Result<std::unique_ptr<bus::MemoryWindow>>()> open_board_window{};
  Clock* real_clock{nullptr};               // nullptr: virtual time, nothing sleeps
  const Clock* world_clock{nullptr};        // of worlds that take their time; nullptr: real_clock
  const Clock* stopwatch{nullptr};          // nullptr: the arm's own clock
  rt::WakeSignal* wake{nullptr};            // of the net plane
  link::DatagramNetwork* network{nullptr};  // to other hosts; nullptr: there is none
  link::LinePorts* lines{nullptr};          // likewise, serial ones
  const Clock* network_clock{nullptr};      // of the links by either; nullptr: real_clock
  std::uint32_t first_session{1};           // of the world halves: see GhostPointWorld
  // Puts something between a simulated arm's bus and its session, such as a bad cable.
  std::function<std::unique_ptr<bus::BusEnumerator>(bus::BusEnumerator&, const Clock&)>
      wrap_sim_bus{};
  // Puts something between an arm's link and its session, such as a world that lies; nullptr:
  // nothing.
  std::function<std::unique_ptr<coupling::ArmLink>(coupling::ArmLink&)> wrap_link{};
  // The far end of an arm whose peer is another arm, here or elsewhere; Runtime's.
  std::function<std::unique_ptr<coupling::WorldCoupling>(const config::ArmConfig& arm)>
      make_peer_half{};
  // Hears why a start waits: somebody else holds an arm.
  std::function<void(const Error&)> on_wait{};
};

// Of links to other hosts; nullptr: none can be kept.
[[nodiscard]] const Clock* network_clock(const RigParts& parts) noexcept;

// One arm with everything below and beside it: bus and time, device, coupling, servo, link.
//
// Thread: session().loop() and clock() are the servo thread's; the rest is the control
//         thread's, and pump() and link_status() the net plane's.
class ArmRig {
 public:
  // `world`: has the local world of the arm; nullptr when arm.link names a remote one. With
  // arm.fallback, and while the arm's device is not there, a rig of a simulated arm.
  [[nodiscard]] static Result<std::unique_ptr<ArmRig>> create(const config::ArmConfig& arm,
                                                              const config::ServoConfig& servo,
                                                              WorldHost* world,
                                                              const RigParts& parts);
  // The same for an arm that AwaitedArm found.
  [[nodiscard]] static Result<std::unique_ptr<ArmRig>> create_found(
      const config::ArmConfig& arm, const config::ServoConfig& servo, WorldHost* world,
      const RigParts& parts, Opened opened);
  // A rig in the place of a real arm that cannot be had now, and `why` not: its session is Lost
  // until Runtime finds the arm. Errors: what is wrong with more than the device.
  [[nodiscard]] static Result<std::unique_ptr<ArmRig>> create_lost(const config::ArmConfig& arm,
                                                                   const config::ServoConfig& servo,
                                                                   WorldHost* world,
                                                                   const RigParts& parts,
                                                                   const Error& why);

  [[nodiscard]] ArmSession& session() noexcept { return *session_; }
  // What the servo sleeps on.
  [[nodiscard]] Clock& clock() noexcept { return *clock_; }
  std::optional<MonotonicTime> pump(MonotonicTime now) { return link_->pump(now); }
  [[nodiscard]] link::LinkStatus link_status() const { return link_->status(); }
  // Where the arm is plugged in; arms may share it, so Runtime::follow_buses() reads its events.
  [[nodiscard]] bus::BusEnumerator& buses() noexcept { return *buses_; }
  // As ArmSession::follow(); a simulated person does what a real one would read in the status.
  Result<void> follow(MonotonicTime now);
  // The real arm whose place this one keeps; nullptr: none.
  [[nodiscard]] AwaitedArm* awaited() noexcept { return awaited_ ? &*awaited_ : nullptr; }
  // Why a real arm is lost that is there, or was not at the start; empty when nothing is wrong.
  [[nodiscard]] std::string trouble() const;
  // nullptr for a real device.
  [[nodiscard]] SimArm* sim_arm() noexcept { return sim_arm_.get(); }

 private:
  ArmRig() = default;
  [[nodiscard]] devices::DeviceExecutor& executor_of(const config::ArmConfig& arm,
                                                     const RigParts& parts);
  // `instead`: the name of its stand-in, or why there is nothing.
  template <class Instead>
  void await(const config::ArmConfig& arm, const Instead& instead, const RigParts& parts);
  [[nodiscard]] static Result<std::unique_ptr<ArmRig>> create_stand_in(
      const config::ArmConfig& arm, const config::ServoConfig& servo, WorldHost* world,
      const RigParts& parts);
  template <class MakeSession>
  [[nodiscard]] static Result<std::unique_ptr<ArmRig>> make(const config::ArmConfig& arm,
                                                            WorldHost* world, const RigParts& parts,
                                                            const MakeSession& make_session);
  // All but the session. Errors: without the arm's name.
  [[nodiscard]] Result<void> connect(const config::ArmConfig& arm, WorldHost* world,
                                     const RigParts& parts);
  [[nodiscard]] Result<void> choose_bus(const config::ArmConfig& arm, const RigParts& parts);
  [[nodiscard]] Result<void> link_to(WorldHost* world, const config::ArmConfig& arm,
                                     const RigParts& parts);
  [[nodiscard]] coupling::ArmLink& arm_end() noexcept {
    return placed_link_ ? static_cast<coupling::ArmLink&>(*placed_link_) : link_->arm_end();
  }
  [[nodiscard]] ArmSessionParts session_parts(const config::ArmConfig& arm, WorldHost* world,
                                              const RigParts& parts);

  devices::InlineExecutor inline_executor_;
  devices::DeviceExecutor* executor_{&inline_executor_};
  std::optional<AwaitedArm> awaited_;
  std::unique_ptr<SimArm> sim_arm_;
  std::optional<sim::RealTimeBrake> brake_;
  std::unique_ptr<bus::BusEnumerator> wrapped_buses_;  // of RigParts::wrap_sim_bus
  Clock* clock_{nullptr};
  bus::BusEnumerator* buses_{nullptr};
  std::unique_ptr<RigLink> link_;
  std::optional<coupling::PlacedLink> placed_link_;  // where the arm stands elsewhere
  std::unique_ptr<coupling::ArmLink> wrapped_link_;  // of RigParts::wrap_link
  std::unique_ptr<ArmSession> session_;              // last: it uses all of the above
};

}  // namespace thimble::session
