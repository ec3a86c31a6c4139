#pragma once

#include <cstdint>

#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "sim/bus/supply.hpp"
#include "sim/export/misbehaviour.hpp"
#include "sim/export/model_log.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::sim {

struct PlugCounters {
  std::uint64_t to_host{0};    // reports or packets that the kernel was given
  std::uint64_t from_host{0};  // that the model was given
  // Came from the host in the same frame as a newer one: not given to the model.
  std::uint64_t superseded{0};
  // The other way: what the kernel did not take, or a stalled device refused.
  std::uint64_t lost{0};
  std::uint64_t requests{0};   // to the control pipe
  std::uint64_t malformed{0};  // what came over the connection and is none of its messages
  bool operator==(const PlugCounters&) const = default;
};

// The plug by which a model hangs on a real kernel.
// Thread: that which runs the model's clock. Not RT. Ownership: see those that derive from it.
class Plug {
 public:
  virtual ~Plug() = default;
  // Busy when it is plugged in already, System when the kernel refuses.
  virtual Result<void> plug() = 0;
  // NotFound when it is not plugged in, System as above. Where the cable alone was pulled before,
  // its supply may go, too.
  virtual Result<void> unplug(Supply supply) = 0;
  [[nodiscard]] virtual bool is_plugged() const noexcept = 0;
  // Somebody on the kernel's side uses it.
  [[nodiscard]] virtual bool is_open() const noexcept = 0;
  // It is on a wire that has them: they can halt. Else the kernel has reports of it, and no more.
  [[nodiscard]] virtual bool has_endpoints() const noexcept = 0;
  // The connection to the kernel is gone for good.
  [[nodiscard]] virtual bool is_broken() const noexcept = 0;
  [[nodiscard]] virtual PlugCounters counters() const noexcept = 0;

  // How often it looks at the kernel, and at its model; on the model's clock.
  [[nodiscard]] virtual Duration round_period() const noexcept = 0;
  // The next round in which something happens even if the kernel says nothing; never more than a
  // frame away.
  [[nodiscard]] virtual MonotonicTime next_needed() const noexcept = 0;
  // Waits on the machine's clock: true as soon as the kernel has said something for which a round
  // is needed before next_needed().
  [[nodiscard]] virtual bool wait_for_kernel(MonotonicTime until) noexcept = 0;
  // The model goes on to `t`, which is before the next round, and nobody is looked at.
  virtual void advance_model(MonotonicTime t) noexcept = 0;
  // Rounds before that are passed without a look, and what they would have done is left undone.
  virtual void leave_out_until(MonotonicTime t) noexcept = 0;
};

// What a plug has around it: none is nullptr, and all must outlive it.
struct PlugSurroundings {
  VirtualClock* clock{nullptr};   // the model's
  const Clock* machine{nullptr};  // only read, for the log
  ModelLog* log{nullptr};
  Misbehaviour* misbehaviour{nullptr};

  [[nodiscard]] LogTime time(MonotonicTime now) const noexcept { return {now, machine->now()}; }
};

}  // namespace thimble::sim
