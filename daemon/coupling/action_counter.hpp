#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "daemon/coupling/messages.hpp"
#include "daemon/world/hand_action.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::coupling {

// Counts what is asked of the world in the name of an arm's hand, and writes the counts into its
// samples, of which any may be lost or replaced on their way (decision 0480).
//
// Thread: ask() from any, count() from one servo thread. RT: count() is THIMBLE_RT. Errors: none.
class ActionCounter {
 public:
  void ask(world::HandAction action) noexcept {
    asked_[static_cast<std::size_t>(action)].fetch_add(1, std::memory_order_relaxed);
  }
  THIMBLE_RT void count(HandSample& sample) const noexcept {
    for (std::size_t i = 0; i < asked_.size(); ++i) {
      const std::uint32_t asked = asked_[i].load(std::memory_order_relaxed);
      sample.actions[i] = static_cast<std::uint8_t>(asked);
      sample.has_actions = sample.has_actions || asked != 0;
    }
  }

 private:
  std::array<std::atomic<std::uint32_t>, world::kHandActions> asked_{};
};

}  // namespace thimble::coupling
