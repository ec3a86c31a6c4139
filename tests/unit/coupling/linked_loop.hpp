#pragma once

#include <chrono>
#include <optional>
#include <utility>

#include "daemon/coupling/arm_coupling.hpp"
#include "daemon/link/in_process_link.hpp"

namespace thimble::coupling::testing {

// Half of it in each direction.
inline link::ImpairmentSettings delayed_by(double delay_s) { return {.delay_s = delay_s}; }

// Arm half, world half and the daemon's own link between them, in virtual time: delay, jitter,
// loss, doubling and reordering are the link's.
class LinkedLoop {
 public:
  LinkedLoop(ArmCoupling& arm, WorldCoupling& world, Duration dt,
             const link::ImpairmentSettings& impairment)
      : arm_(arm), link_({.impairment = impairment}, world), dt_(dt) {}

  ArmOutput tick(Position3 tip, Velocity3 velocity) {
    if (std::exchange(is_first_, false)) arm_.reset(now_, tip);
    run_link_until(now_ + dt_);
    now_ = now_ + dt_;
    ConstraintSet reply;
    const bool is_fresh = link_.arm_end().receive(reply) && is_up;
    const ArmOutput output = arm_.step({.now = now_,
                                        .dt = dt_,
                                        .tip = tip,
                                        .tip_velocity = velocity,
                                        .buttons = 0,
                                        .fresh = is_fresh ? &reply : nullptr,
                                        .link = link_.arm_end().quality()});
    if (is_up) link_.arm_end().send(output.sample);
    link_.pump(now_);
    return output;
  }

  [[nodiscard]] Duration dt() const { return dt_; }
  [[nodiscard]] MonotonicTime now() const { return now_; }
  [[nodiscard]] link::LinkStatus status() const { return link_.status(); }

  bool is_up{true};  // the network

 private:
  void run_link_until(MonotonicTime end) {
    std::optional<MonotonicTime> due = link_.pump(now_);
    while (due && *due <= end) due = link_.pump(*due);
  }

  ArmCoupling& arm_;
  link::InProcessLink link_;
  Duration dt_;
  MonotonicTime now_{};
  bool is_first_{true};
};

}  // namespace thimble::coupling::testing
