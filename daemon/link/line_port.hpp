#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "daemon/link/serial_frame.hpp"
#include "daemon/link/serial_line.hpp"
#include "hal/base/time.hpp"

namespace thimble::link {

// A serial port and a timer on the net plane, for the two ends that speak along it. Includes Asio:
// only for .cpp files of this folder.
//
// A port that cannot be opened, or is gone, is no error of the link: it is opened again each
// kOpenAgain. The handlers given to start() run until this is destroyed and never after.
//
// Thread: the one that runs the io_context. RT: not. Ownership: the io_context must outlive it.
// Errors: none; the newest is in last_error(), nothing while all is well.
class LinePort {
 public:
  static constexpr Duration kOpenAgain = std::chrono::seconds(1);  // ours
  struct Handlers {
    std::function<void(std::span<const std::byte>)> on_bytes;
    std::function<void()> on_timer;  // also when there is room again
  };

  LinePort(boost::asio::io_context& io, OpenLine open);
  ~LinePort();
  LinePort(const LinePort&) = delete;
  LinePort& operator=(const LinePort&) = delete;

  void start(Handlers handlers);
  // Open, and the kernel has taken all of the last frame.
  [[nodiscard]] bool has_room() const noexcept { return node_ != nullptr && !is_writing_; }
  // Only while has_room().
  void send(const SerialFrame& frame);
  // on_timer runs after `wait`, or earlier when that was asked for before.
  void wake_after(MonotonicTime now, Duration wait);
  [[nodiscard]] const std::string& last_error() const noexcept { return last_error_; }

 private:
  // As of UdpPort.
  struct Alive {
    Handlers handlers;
  };

  void open();
  void close(const std::string& why);
  void open_later();
  void receive_next();

  boost::asio::posix::stream_descriptor line_;
  boost::asio::steady_timer timer_;
  boost::asio::steady_timer open_timer_;
  OpenLine open_;
  LineNode node_;  // none: closed
  std::optional<MonotonicTime> wakes_at_;
  std::shared_ptr<Alive> alive_;
  std::array<std::byte, 4096> buffer_{};
  // What Asio still writes when the port is closed and opened again.
  std::shared_ptr<const SerialFrame> leaving_;
  bool is_writing_{false};
  std::string last_error_;
};

}  // namespace thimble::link
