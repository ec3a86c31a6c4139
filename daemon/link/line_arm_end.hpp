#pragma once

#include <memory>
#include <optional>
#include <span>

#include "daemon/coupling/arm_link.hpp"
#include "daemon/coupling/messages.hpp"
#include "daemon/link/arm_end_settings.hpp"
#include "daemon/link/link_counters.hpp"
#include "daemon/link/serial_frame.hpp"

namespace thimble::link {

// The arm's end of either protocol on a serial line, without the line: bytes in, frames out.
//
// A line has no room for every sample: a sample of our own takes 36 ms at 38,400 bit/s. So nothing
// is handed to it before it is free (LinePace), and what then leaves is the newest.
//
// Thread: one, the net plane's. RT: not. Ownership: all that it has is its own; bytes are read
// before the call returns. Errors: none end it; all are counted, damaged frames as receive errors.
class LineArmEnd {
 public:
  virtual ~LineArmEnd() = default;
  // Replaces a sample that has not left yet.
  virtual void offer(const coupling::HandSample& sample) noexcept = 0;
  // What the line brought, however it was cut.
  virtual void on_bytes(std::span<const std::byte> bytes, MonotonicTime now) = 0;
  // True and `out` set when a frame is to leave now.
  virtual bool poll(MonotonicTime now, SerialFrame& out) = 0;
  // True and `out` set when a reply comes into force; call until false, then poll().
  virtual bool take_reply(MonotonicTime now, coupling::ConstraintSet& out) = 0;
  // When to poll and take again at the latest.
  [[nodiscard]] virtual std::optional<MonotonicTime> next_due() const = 0;
  [[nodiscard]] virtual coupling::LinkQuality quality() const noexcept = 0;
  [[nodiscard]] virtual LinkStatus status() const = 0;
};

// `bit_per_s`: of the line.
[[nodiscard]] std::unique_ptr<LineArmEnd> make_line_arm_end(const ArmEndSettings& settings,
                                                            std::uint32_t bit_per_s);

}  // namespace thimble::link
