#pragma once

#include <memory>
#include <optional>
#include <string>

#include "daemon/config/config.hpp"
#include "daemon/coupling/arm_link.hpp"
#include "daemon/coupling/world_coupling.hpp"
#include "daemon/link/datagram_port.hpp"
#include "daemon/link/line_port.hpp"
#include "daemon/link/link_counters.hpp"
#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/rt/wake_signal.hpp"

namespace thimble::session {

// The link of one arm, whatever carries it, together with the world half of its coupling
// where that is on this side.
//
// Thread: arm_end() is the servo's; the rest belongs to the net plane's one thread.
class RigLink {
 public:
  virtual ~RigLink() = default;
  [[nodiscard]] virtual coupling::ArmLink& arm_end() noexcept = 0;
  // Moves what is due; returns when to come again at the latest, a wake comes on top.
  virtual std::optional<MonotonicTime> pump(MonotonicTime now) = 0;
  [[nodiscard]] virtual link::LinkStatus status() const = 0;
};

// Arm and world in this process. The world of `world_half` must outlive the link; `hears_actions`
// as World::has_actions().
[[nodiscard]] std::unique_ptr<RigLink> make_in_process_link(
    const config::ArmConfig& arm, std::unique_ptr<coupling::WorldCoupling> world_half,
    bool hears_actions, rt::WakeSignal* wake);

// The world is behind `arm.link`. `network` and `clock` must outlive the link.
// Errors: no port of it can be opened.
[[nodiscard]] Result<std::unique_ptr<RigLink>> make_udp_link(const config::ArmConfig& arm,
                                                             link::DatagramNetwork& network,
                                                             const Clock& clock,
                                                             rt::WakeSignal* wake);

// The world is behind the serial line `arm.line`. `ports` and `clock` must outlive the link.
// Errors: its key file's.
[[nodiscard]] Result<std::unique_ptr<RigLink>> make_serial_link(const config::ArmConfig& arm,
                                                                link::LinePorts& ports,
                                                                const Clock& clock,
                                                                rt::WakeSignal* wake);

}  // namespace thimble::session
