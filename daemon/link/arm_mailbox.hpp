#pragma once

#include <atomic>

#include "daemon/coupling/arm_link.hpp"
#include "hal/rt/triple_buffer.hpp"
#include "hal/rt/wake_signal.hpp"

namespace thimble::link {

// The arm end of every link: what the servo writes and reads without waiting, whatever
// carries it on the net plane's side.
//
// Thread: the ArmLink calls from the servo thread, the others from the net plane's.
// RT: send(), receive(), quality() as ArmLink says.
// Ownership: the wake signal must outlive it; none: the net plane looks by itself. Errors: none; of
// several samples or replies the newest is there.
class ArmMailbox final : public coupling::ArmLink {
 public:
  explicit ArmMailbox(rt::WakeSignal* wake) noexcept : wake_(wake) {}

  THIMBLE_RT_IO void send(const coupling::HandSample& sample) noexcept override {
    samples_.write(sample);
    if (wake_ != nullptr) wake_->signal();
  }
  THIMBLE_RT bool receive(coupling::ConstraintSet& out) noexcept override {
    return replies_.read(out);
  }
  // The three values are read one by one: after a change they may be of two neighbouring
  // moments, which no threshold built on them can tell.
  [[nodiscard]] THIMBLE_RT coupling::LinkQuality quality() const noexcept override {
    return {.is_up = is_up_.load(std::memory_order_relaxed),
            .round_trip = Duration(round_trip_.load(std::memory_order_relaxed)),
            .jitter = Duration(jitter_.load(std::memory_order_relaxed))};
  }

  // The newest sample since the last call. False: none, `out` untouched.
  bool take(coupling::HandSample& out) noexcept { return samples_.read(out); }
  void deliver(const coupling::ConstraintSet& reply) noexcept { replies_.write(reply); }
  void publish(const coupling::LinkQuality& quality) noexcept {
    is_up_.store(quality.is_up, std::memory_order_relaxed);
    round_trip_.store(quality.round_trip.count(), std::memory_order_relaxed);
    jitter_.store(quality.jitter.count(), std::memory_order_relaxed);
  }

 private:
  rt::WakeSignal* wake_;
  rt::TripleBuffer<coupling::HandSample> samples_;
  rt::TripleBuffer<coupling::ConstraintSet> replies_;
  std::atomic<bool> is_up_{false};
  std::atomic<Duration::rep> round_trip_{0};
  std::atomic<Duration::rep> jitter_{0};
};

}  // namespace thimble::link
