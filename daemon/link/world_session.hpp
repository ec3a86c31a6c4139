#pragma once

#include <string>

#include "daemon/coupling/world_coupling.hpp"
#include "daemon/link/link_counters.hpp"

namespace thimble::link {

// The hand's stay in the world as a world end sees it: opened by the first sample, closed
// when no sample came for kSilence.
//
// Thread: the net plane's. RT: not; answer() neither allocates nor blocks once open.
// Ownership: the coupling must outlive it; closed with it.
// Errors: open() hands on the coupling's refusal and counts it.
class WorldSession {
 public:
  // Bounds of what a scheme is told of the time between two samples: a world may not move by
  // more than a blink because a hand was away, nor by nothing because two came at once.
  static constexpr Duration kMinStep = std::chrono::microseconds(1);
  static constexpr Duration kMaxStep = std::chrono::milliseconds(50);

  // Ours: how long to wait before a world that refused the hand is asked again. To look for a free
  // place may take it long.
  static constexpr Duration kRetry = std::chrono::milliseconds(100);

  explicit WorldSession(coupling::WorldCoupling& world) noexcept : world_(&world) {}
  ~WorldSession() { close(); }
  WorldSession(const WorldSession&) = delete;
  WorldSession& operator=(const WorldSession&) = delete;

  [[nodiscard]] bool is_open() const noexcept { return is_open_; }
  bool open(const coupling::HandSample& first, MonotonicTime now, LinkCounters& counters);
  // Only while open.
  [[nodiscard]] coupling::ConstraintSet answer(const coupling::HandSample& sample,
                                               MonotonicTime now) noexcept;
  // True when it was open and the silence has lasted: it is closed now.
  bool release_if_silent(MonotonicTime now, LinkCounters& counters) noexcept;
  void close() noexcept;
  // Meaningful while open.
  [[nodiscard]] MonotonicTime silent_at() const noexcept { return heard_at_ + kSilence; }
  [[nodiscard]] const std::string& last_error() const noexcept { return last_error_; }

 private:
  coupling::WorldCoupling* world_;
  bool is_open_{false};
  MonotonicTime heard_at_{};
  std::string last_error_;
};

}  // namespace thimble::link
