#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/base/time.hpp"
#include "hal/bus/hid_device.hpp"
#include "hal/rt/annotations.hpp"
#include "hal/rt/triple_buffer.hpp"

namespace thimble::sim {

class SimHidPort;

// The host's end of one simulated HID connection: two mailboxes that the port empties and
// fills once per USB frame.
//
// Thread: HidDevice's side as there; take_out() and deliver() from the thread that runs the
// clock (which may be the same).
// RT: all THIMBLE_RT; no system call, no allocation.
// Ownership: closes its port's connection when destroyed; the port must outlive it.
// Errors: Disconnected from the unplug on, whatever is plugged in later.
class SimHid final : public bus::HidDevice {
 public:
  SimHid(SimHidPort& port, std::uint64_t generation, std::size_t output_report_bytes) noexcept;
  ~SimHid() override;
  SimHid(const SimHid&) = delete;
  SimHid& operator=(const SimHid&) = delete;

  THIMBLE_RT_IO IoStatus read_newest(bus::HidReport& out) noexcept override;
  THIMBLE_RT_IO IoStatus submit(std::span<const std::uint8_t> report) noexcept override;
  // reports_skipped is up to date after a read, writes_superseded after a frame.
  [[nodiscard]] bus::HidCounters counters() const noexcept override;

  // Port side, once per frame. take_out() returns the newest report that was submitted since
  // the last frame, or an empty span; it is valid until the next call.
  THIMBLE_RT std::span<const std::uint8_t> take_out() noexcept;
  THIMBLE_RT void deliver(std::span<const std::uint8_t> report, MonotonicTime arrived_at) noexcept;

 private:
  struct OutReport {
    std::array<std::uint8_t, bus::kMaxHidReportBytes> bytes{};
    std::size_t size{0};
    std::uint64_t number{0};  // 1 for the first submit
  };

  SimHidPort* port_;
  std::uint64_t generation_;  // of the port when this connection was opened
  std::size_t output_report_bytes_;
  rt::TripleBuffer<bus::HidReport> in_;
  rt::TripleBuffer<OutReport> out_;
  // Host thread.
  std::uint64_t last_read_{0};
  std::uint64_t submitted_{0};
  std::atomic<std::uint64_t> reports_skipped_{0};
  // Clock thread.
  OutReport taken_report_{};
  std::atomic<std::uint64_t> taken_{0};  // number of the last report that went out
  std::atomic<std::uint64_t> reports_in_{0};
  std::atomic<std::uint64_t> reports_out_{0};
  std::atomic<std::uint64_t> writes_superseded_{0};
};

}  // namespace thimble::sim
