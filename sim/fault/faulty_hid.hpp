#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "hal/base/time.hpp"
#include "hal/bus/hid_device.hpp"
#include "hal/rt/annotations.hpp"
#include "sim/fault/fault_dice.hpp"
#include "sim/fault/fault_plan.hpp"

namespace thimble::sim {

// Any HID device behind a bad cable: passes everything on, but for what the plan says.
//
// It sees an input report when its user reads, as the device below keeps only the newest: a
// dropped report does not bring back the one before it. A delayed report is stamped with the
// time at which it is let through, and reports never overtake each other. `sequence` counts
// the reports that arrived here, so a dropped one leaves no gap. Stalled input is lost, and the
// newest stalled output report goes out with the first call after the stall; where only writes are
// blocked (a Stall of kHidOut), input passes meanwhile. A delayed output
// report goes out with the first call after its delay, and none overtakes it; where too many
// wait, the newest takes the place of the one before it.
//
// Thread: as HidDevice. RT: THIMBLE_RT_IO, as the device below; no allocation.
// Ownership: owns the device below. The clock must outlive it and be the one that stamps the
// reports below.
// Errors: as the device below; Disconnect latches.
class FaultyHid final : public bus::HidDevice {
 public:
  FaultyHid(std::unique_ptr<bus::HidDevice> device, const Clock& clock, const FaultPlan& plan,
            std::shared_ptr<FaultTally> tally = std::make_shared<FaultTally>());
  ~FaultyHid() override;
  FaultyHid(const FaultyHid&) = delete;
  FaultyHid& operator=(const FaultyHid&) = delete;

  THIMBLE_RT_IO IoStatus read_newest(bus::HidReport& out) noexcept override;
  THIMBLE_RT_IO IoStatus submit(std::span<const std::uint8_t> report) noexcept override;
  // As its user sees them: a dropped report is neither in nor skipped, a write that was
  // dropped here went out.
  [[nodiscard]] bus::HidCounters counters() const noexcept override;
  [[nodiscard]] FaultCounts injected() const noexcept { return dice_.tally().read(); }

 private:
  // Reports under way while a delay lasts: 64 ms of a 1 kHz device. More are lost.
  static constexpr std::size_t kMaxDelayed = 64;

  struct OutReport {
    std::array<std::uint8_t, bus::kMaxHidReportBytes> bytes{};
    std::size_t size{0};
    std::uint64_t number{0};
    MonotonicTime leaves_at{};  // of a delayed one
  };

  [[nodiscard]] bool is_disconnected(MonotonicTime now) noexcept;
  [[nodiscard]] bool is_stalled(MonotonicTime now) const noexcept;
  [[nodiscard]] bool is_out_stalled(MonotonicTime now) const noexcept;
  void lose_stalled_input() noexcept;
  void take_in(bus::HidReport& report) noexcept;
  void spoil(bus::HidReport& report, std::uint64_t number) noexcept;
  void enqueue(const bus::HidReport& report) noexcept;
  void lose(std::uint64_t reports, FaultKind kind) noexcept;
  void publish_not_arrived() noexcept;
  IoStatus hand_over(bus::HidReport& out) noexcept;
  IoStatus send(std::span<const std::uint8_t> report, MonotonicTime now,
                std::uint64_t number) noexcept;
  void hold(std::span<const std::uint8_t> report) noexcept;
  void send_held(MonotonicTime now) noexcept;
  IoStatus send_or_delay(std::span<const std::uint8_t> report, MonotonicTime now,
                         std::uint64_t number) noexcept;
  void delay_out(std::span<const std::uint8_t> report, MonotonicTime leaves_at,
                 std::uint64_t number) noexcept;
  void send_delayed(MonotonicTime now) noexcept;

  std::unique_ptr<bus::HidDevice> device_;
  const Clock* clock_;
  FaultDice dice_;
  FaultDice blocked_writes_;  // the stalls of output alone
  bool is_disconnected_{false};
  MonotonicTime stalled_until_{Duration::min()};  // by chance; the script knows its own

  std::array<bus::HidReport, kMaxDelayed> queue_{};  // ring, oldest first, by arrived_at
  std::size_t queue_first_{0};
  std::size_t queue_size_{0};
  std::uint64_t seen_below_{0};  // sequence of the last report read from below
  std::uint64_t lost_{0};        // of those: never arrive here
  MonotonicTime last_arrival_{Duration::min()};
  std::uint64_t last_read_{0};

  OutReport held_{};  // submitted during a stall; size 0: none
  std::uint64_t submitted_{0};
  std::array<OutReport, kMaxDelayed> out_queue_{};  // ring, oldest first, by leaves_at
  std::size_t out_first_{0};
  std::size_t out_size_{0};

  // What counters() needs beyond the device below.
  std::atomic<std::uint64_t> not_arrived_{0};  // lost or still queued
  std::atomic<std::uint64_t> reports_skipped_{0};
  std::atomic<std::uint64_t> dropped_out_{0};
  std::atomic<std::uint64_t> superseded_here_{0};
};

}  // namespace thimble::sim
