#pragma once

#include <atomic>
#include <thread>

#include "hal/rt/annotations.hpp"

namespace thimble::sim {

// Who holds a simulated device open, shared between the thread that opens and closes and the
// one that runs the frames: after detach() no frame touches that host.
//
// A frame announces in `in_frame_` whom it is about to touch and then looks again whether that
// is still the host; detach() changes the host and then waits for the announcement to go.
// Sequentially consistent, as the proof needs each side to see the other's first step.
//
// Thread: attach(), detach() and is_taken() from one control thread; visit() from the thread that
// runs the clock. RT: visit() is THIMBLE_RT; detach() waits at most for the frame under way.
// Ownership: points at the host only.
template <class Host>
class HostSlot {
 public:
  [[nodiscard]] bool is_taken() const noexcept { return host_.load() != nullptr; }
  [[nodiscard]] Host* host() const noexcept { return host_.load(); }
  void attach(Host& host) noexcept { host_.store(&host); }
  // Nothing when it is not, or no longer, the host.
  void detach(Host& host) noexcept {
    Host* expected = &host;
    host_.compare_exchange_strong(expected, nullptr);
    while (in_frame_.load() == &host) std::this_thread::yield();
  }
  // Calls `frame` with the host, or with nullptr when there is none.
  template <class Frame>
  THIMBLE_RT void visit(const Frame& frame) noexcept {
    Host* host = host_.load();
    in_frame_.store(host);
    frame(host_.load() == host ? host : nullptr);
    in_frame_.store(nullptr);
  }

 private:
  std::atomic<Host*> host_{nullptr};
  std::atomic<Host*> in_frame_{nullptr};
};

}  // namespace thimble::sim
