#pragma once

#include <atomic>
#include <cstdint>

#include "daemon/coupling/action_counter.hpp"

namespace thimble::servo {

// One wish to clear one fault: never taken twice, never for another fault.
struct alignas(8) ClearRequest {
  std::uint32_t id{0};     // each differs from the one before
  std::uint32_t fault{0};  // Fault::number
};

// What the control thread asks of a servo; read once per tick.
// Thread: any may set, but only one asks to clear faults; the servo reads.
// RT: plain atomics.
struct ServoControls {
  std::atomic<bool> want_active{false};
  std::atomic<ClearRequest> clear_request{};
  static_assert(decltype(clear_request)::is_always_lock_free);
  // Safety inputs, as the safety thread last saw them. Without wiring they stay as they are.
  std::atomic<bool> is_estop_healthy{true};
  std::atomic<bool> is_deadman_held{true};
  // Of an arm that needs a guard: it watches. Without one the arm is not driven.
  std::atomic<bool> is_guarded{true};
  // What is asked of the world in the name of the arm's hand; said while the arm is driven.
  coupling::ActionCounter actions;

  // Asks once that fault number `fault` be cleared; the id with which the servo answers in
  // ServoSnapshot::clear_answered. A newer request takes the place of one not answered yet.
  std::uint32_t request_clear(std::uint32_t fault) noexcept {
    const std::uint32_t id = clear_request.load(std::memory_order_relaxed).id + 1;
    clear_request.store({id, fault}, std::memory_order_relaxed);
    return id;
  }
};

}  // namespace thimble::servo
