#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <span>
#include <string>

#include "daemon/link/line_port.hpp"
#include "daemon/link/tty_ports.hpp"
#include "daemon/link/wake_timer.hpp"

namespace thimble::link {

// A serial port and a timer of the system. Includes Asio: only for .cpp files of this folder.
//
// Thread: the one that runs the io_context, which must outlive it. The rest: see LinePort.
class TtyPort final : public LinePort {
 public:
  using Open = std::function<std::future<Result<LineNode>>()>;

  TtyPort(boost::asio::io_context& io, Open open);
  ~TtyPort() override;

  void start(Handlers handlers) override;
  // Open, and the kernel has taken all of the last frame.
  [[nodiscard]] bool has_room() const noexcept override { return node_ != nullptr && !is_writing_; }
  void send(const SerialFrame& frame) override;
  void wake_after(MonotonicTime now, Duration wait) override;
  [[nodiscard]] const std::string& last_error() const noexcept override { return last_error_; }

 private:
  // As of UdpPort.
  struct Alive {
    Handlers handlers;
  };

  void open();
  void look_for_answer();
  void use(Result<LineNode> node);
  void close(const std::string& why);
  void after(Duration wait, void (TtyPort::*then)());
  void receive_next();

  boost::asio::posix::stream_descriptor line_;
  WakeTimer timer_;
  boost::asio::steady_timer open_timer_;
  Open open_;
  std::future<Result<LineNode>> opening_;
  LineNode node_;                // none: closed
  std::uint64_t generation_{0};  // of it: what was asked of one before is of no use
  std::shared_ptr<Alive> alive_;
  std::array<std::byte, 4096> buffer_{};
  // What Asio still writes when the port is closed and opened again.
  std::shared_ptr<const SerialFrame> leaving_;
  bool is_writing_{false};
  std::string last_error_;
};

}  // namespace thimble::link
