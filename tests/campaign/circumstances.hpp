#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tests/campaign/edits.hpp"
#include "tests/campaign/invariant.hpp"
#include "tests/campaign/programme.hpp"
#include "tests/support/closed_loop.hpp"

namespace thimble::campaign {

// Makes a programme's events happen to a session, and knows what is happening to it now.
//
// Thread: that of the loop, which it must not outlive.
class Circumstances {
 public:
  Circumstances(const Programme& programme, test::ClosedLoop& loop);

  // Before a tick: what begins or ends until now. How late the servo wakes for it.
  [[nodiscard]] Duration prepare(MonotonicTime now);
  // After it: what an invariant has to know of them.
  void describe(Observation& observation);
  [[nodiscard]] std::uint64_t edits_applied() const noexcept { return edits_.applied(); }
  [[nodiscard]] const std::array<std::uint64_t, kEventKindCount>& happened() const noexcept {
    return happened_;
  }

 private:
  struct Edge {
    MonotonicTime at{};
    std::size_t event{0};
    bool is_begin{true};
  };
  void begin(const Event& event);
  void end(const Event& event);
  void apply(EventKind kind);
  void ask_to_clear(bool is_for_other);
  void fill(const Event& event, bool is_filled);
  // The tip as the world sees it.
  [[nodiscard]] Position3 hand();
  [[nodiscard]] bool is_on(EventKind kind) const noexcept {
    return on_[static_cast<std::size_t>(kind)] > 0;
  }
  // Also what came and went while the servo slept.
  [[nodiscard]] bool has_been_on(EventKind kind) const noexcept {
    return is_on(kind) || was_on_[static_cast<std::size_t>(kind)];
  }
  [[nodiscard]] bool is_cable_disturbed() const noexcept;
  // Whether single reports suffered anything since the last tick.
  [[nodiscard]] bool look_at_reports(Observation& observation);
  void look_at_world(Observation& observation);

  const Programme* programme_;
  test::ClosedLoop* loop_;
  Edits edits_;
  std::vector<Edge> edges_;  // by time
  std::size_t next_{0};
  std::array<int, kEventKindCount> on_{};  // how many of a kind last
  std::bitset<kEventKindCount> was_on_{};  // began or ended since the last tick
  std::array<std::uint64_t, kEventKindCount> happened_{};
  Force3 push_{};
  Duration late_{};
  sim::FaultCounts injected_{};
  std::uint64_t cut_{0};
  std::uint32_t clear_asked_{0};
  bool is_clear_for_other_{false};
  MonotonicTime late_out_at_{Duration::min() / 2};
  MonotonicTime cable_ok_since_{};
  MonotonicTime network_ok_since_{};
  MonotonicTime opening_ok_since_{};
  MonotonicTime world_ok_since_{Duration::min() / 2};
  MonotonicTime tip_ok_since_{Duration::min() / 2};
  MonotonicTime edits_ok_since_{};
  MonotonicTime replies_ok_since_{};
};

}  // namespace thimble::campaign
