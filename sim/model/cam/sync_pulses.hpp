#pragma once

#include <cstdint>

namespace thimble::sim::cam {

// Of a line in clocks, and of a frame in lines: what a monitor shows, and what it takes to return.
struct SyncLengths {
  std::uint32_t scan_clocks{0}, blank_clocks{0};
  std::uint32_t scan_lines{0}, blank_lines{0};
  bool operator==(const SyncLengths&) const = default;
};

// The pulses that synchronized scans wait for, as two ganged counters of the interface make them
// (docs/cambus.md, section 4; STEP Technical Reference 7.3.3): HCAM where a line begins, VCAM
// instead where a frame does; where the blank lines begin a pulse to the monitor takes HCAM's
// place. By the machine's clock; of clocks before they were started they say nothing. Pure.
class SyncPulses {
 public:
  // None run.
  SyncPulses() = default;
  // A frame begins at `start_clocks`. None run where lines have no clocks or none is shown.
  SyncPulses(const SyncLengths& lengths, std::uint64_t start_clocks);

  [[nodiscard]] bool run() const noexcept { return line_clocks_ > 0; }
  // When the first one comes, now or later; only where they run.
  [[nodiscard]] std::uint64_t next_line(std::uint64_t now_clocks) const noexcept;
  [[nodiscard]] std::uint64_t next_frame(std::uint64_t now_clocks) const noexcept;
  // Of the pulse that came last: how many frames have begun before it, and lines of its own.
  struct Place {
    std::uint64_t frame{0};
    std::uint64_t line{0};
  };
  [[nodiscard]] Place place_of(std::uint64_t now_clocks) const noexcept;

 private:
  std::uint64_t line_clocks_{0};
  std::uint64_t scan_lines_{0};
  std::uint64_t frame_lines_{0};
  std::uint64_t start_{0};
};

}  // namespace thimble::sim::cam
