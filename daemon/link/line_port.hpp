#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "daemon/link/serial_frame.hpp"
#include "hal/base/time.hpp"

namespace thimble::link {

// One end of a serial line with a timer, for the two ends of a protocol that speak along it.
// TtyPort is that of the system; another line, in another time, has ports of its own.
//
// A port that cannot be opened, or is gone, is no error of the link: it is opened again each
// kOpenAgain. The handlers given to start() run until the port is destroyed and never after.
//
// Thread: the one that its LinePorts run on. RT: not. Ownership: its LinePorts must outlive it.
// Errors: none; the newest is in last_error(), nothing while all is well.
class LinePort {
 public:
  static constexpr Duration kOpenAgain = std::chrono::seconds(1);  // ours
  struct Handlers {
    std::function<void(std::span<const std::byte>)> on_bytes;  // they live until it returns
    std::function<void()> on_timer;                            // also when there is room again
  };

  LinePort() = default;
  virtual ~LinePort() = default;
  LinePort(const LinePort&) = delete;
  LinePort& operator=(const LinePort&) = delete;

  virtual void start(Handlers handlers) = 0;  // once
  // Open, and all of the last frame is taken.
  [[nodiscard]] virtual bool has_room() const noexcept = 0;
  // Only while has_room().
  virtual void send(const SerialFrame& frame) = 0;
  // on_timer runs after `wait`, or earlier when that was asked for before.
  virtual void wake_after(MonotonicTime now, Duration wait) = 0;
  [[nodiscard]] virtual const std::string& last_error() const noexcept = 0;
};

// The serial ports of a machine. Thread: one. RT: not; allocates its ports. Ownership: outlives its
// ports, which are the caller's. Errors: none; a port says its own in last_error().
class LinePorts {
 public:
  virtual ~LinePorts() = default;
  // That of the device `node`, whether it is there or not; not open yet.
  [[nodiscard]] virtual std::unique_ptr<LinePort> make_port(const std::string& node,
                                                            std::uint32_t bit_per_s) = 0;
};

}  // namespace thimble::link
