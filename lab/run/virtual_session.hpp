#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/config/config.hpp"
#include "daemon/session/plugins.hpp"
#include "daemon/session/runtime.hpp"
#include "hal/base/result.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::lab {

// The sessions of a configuration with the daemon's own classes, in a time that runs as fast as the
// machine can: one thread does in turn what the servo threads, the net plane and the control plane
// do. As often as the daemon does it: servos at their rate, links whenever they are due, buses
// every 5 ms.
//
// Thread: one. Ownership: `plugins` must outlive it. Deterministic: the same configuration gives
// the same frames to the last bit.
class VirtualSession {
 public:
  // `config` has nothing of reasons_not_to_play(). Errors: session::Runtime::create()'s.
  [[nodiscard]] static Result<std::unique_ptr<VirtualSession>> create(
      const config::Config& config, const session::Plugins& plugins);

  // One period of the servos.
  void tick();
  [[nodiscard]] std::size_t arms() const { return runtime_->arms().size(); }
  [[nodiscard]] session::ArmRig& arm(std::size_t i) { return *runtime_->arms()[i]; }
  [[nodiscard]] Duration period() const noexcept { return period_; }
  [[nodiscard]] MonotonicTime began() const noexcept { return began_; }
  // What was in the way of an arm, each once.
  [[nodiscard]] const std::vector<std::string>& troubles() const noexcept { return troubles_; }

 private:
  VirtualSession() = default;
  void sleep_until(MonotonicTime t);
  void pump(MonotonicTime now);
  void follow_buses();

  sim::VirtualClock world_clock_;  // of worlds on a board; before the runtime, which uses it
  std::unique_ptr<session::Runtime> runtime_;
  Duration period_{};
  MonotonicTime began_{};
  MonotonicTime next_{};
  MonotonicTime followed_at_{};
  std::optional<MonotonicTime> net_due_;
  std::vector<std::string> troubles_;
};

}  // namespace thimble::lab
