#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/session/plugins.hpp"
#include "daemon/session/runtime.hpp"
#include "hal/base/result.hpp"
#include "lab/run/played_file.hpp"
#include "lab/run/virtual_lines.hpp"
#include "lab/run/virtual_network.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::lab {

// The sessions of one or several configurations with the daemon's own classes, in a time that runs
// as fast as the machine can: one thread does in turn what the servo threads, the net planes and
// the control planes do. As often as the daemon does it: servos at their rate, links whenever they
// are due, buses every 5 ms. Each configuration is another host; VirtualNetwork and VirtualLines
// are between them.
//
// Thread: one. Ownership: `plugins`, one for each file, must outlive it. Deterministic: the same
// files give the same frames to the last bit.
class VirtualSession {
 public:
  // `files` have nothing of reasons_not_to_play(). Errors: session::Runtime::create()'s, with the
  // file where there are several.
  [[nodiscard]] static Result<std::unique_ptr<VirtualSession>> create(
      const std::vector<PlayedFile>& files,
      const std::vector<std::unique_ptr<session::Plugins>>& plugins);

  // One period of the servos.
  void tick();
  // Those of all files, in their order.
  [[nodiscard]] std::size_t arms() const { return places_.size(); }
  [[nodiscard]] session::ArmRig& arm(std::size_t i) {
    return *runtimes_[places_[i].file]->arms()[places_[i].arm];
  }
  [[nodiscard]] std::size_t file_of(std::size_t arm) const { return places_[arm].file; }
  // By file.
  [[nodiscard]] session::Runtime& runtime(std::size_t file) { return *runtimes_[file]; }
  [[nodiscard]] Duration period() const noexcept { return period_; }
  [[nodiscard]] MonotonicTime began() const noexcept { return began_; }
  // What was in the way of an arm, each once.
  [[nodiscard]] const std::vector<std::string>& troubles() const noexcept { return troubles_; }

 private:
  struct Place {
    std::size_t file{0};
    std::size_t arm{0};
  };

  explicit VirtualSession(const std::vector<PlayedFile>& files)
      : network_(host_addresses(files)), lines_(clock_, files.size()) {}
  void sleep_until(MonotonicTime t);
  void pump(MonotonicTime now);
  void follow_buses();

  // Of links, and of worlds on a board. It, network and lines are before the runtimes, which use
  // them.
  sim::VirtualClock clock_;
  VirtualNetwork network_;
  VirtualLines lines_;
  std::vector<std::unique_ptr<session::Runtime>> runtimes_;
  std::vector<Place> places_;
  Duration period_{};
  MonotonicTime began_{};
  MonotonicTime next_{};
  MonotonicTime followed_at_{};
  std::optional<MonotonicTime> net_due_;
  std::vector<std::string> troubles_;
};

}  // namespace thimble::lab
