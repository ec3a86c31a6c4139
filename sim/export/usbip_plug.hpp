#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <cstdint>
#include <list>
#include <memory>
#include <vector>

#include "hal/base/result.hpp"
#include "hal/plugin/sim_usb_model.hpp"
#include "sim/export/plug.hpp"
#include "sim/export/usbip_session.hpp"
#include "sim/time/event_queue.hpp"

namespace thimble::sim {

// Offers a simulated USB device by USB/IP on this machine's loopback: `usbip attach -r 127.0.0.1 -b
// 1-1`. It needs no rights; who attaches does.
//
// Runs the rounds of the device's bus on the model's clock, and looks at its sockets there, without
// waiting. One host has the device at a time; some more may ask what there is, and are then let in
// once in 50 frames. Unplugged the connection closes, which pulls the cable on the other side, and
// nothing is offered. A device with bulk pipes has eight rounds in a frame, as SimUsbPort; one with
// interrupt pipes alone needs but one.
//
// Thread, Errors: as Plug. RT: none of it. Ownership: model and surroundings must outlive it, and
// the io_context.
class UsbipPlug final : public Plug, private Event {
 public:
  static constexpr std::size_t kMostConnections = 4;  // ours: one host, and `usbip list` beside it
  // Who asks nothing for so long, or takes the device and makes no request of it, holds a place
  // that others want, and is hung up on. Ours: a kernel asks for descriptors within 1 s. A host
  // that has it may be idle for ever.
  static constexpr Duration kPatience = std::chrono::seconds(10);

  // `port` 0: one that is free. Errors: Busy when it is taken, else System.
  [[nodiscard]] static Result<std::unique_ptr<UsbipPlug>> listen(
      boost::asio::io_context& io, std::uint16_t port, plugin::SimUsbModel& model,
      UsbPersona persona, const PlugSurroundings& surroundings);
  [[nodiscard]] std::uint16_t port() const;
  [[nodiscard]] Duration round_period() const noexcept override;
  [[nodiscard]] MonotonicTime next_needed() const noexcept override;
  [[nodiscard]] bool wait_for_kernel(MonotonicTime until) noexcept override;
  void leave_out_until(MonotonicTime t) noexcept override { left_out_until_ = t; }

  // A host has it; whether somebody there uses it, is_open() says.
  [[nodiscard]] bool is_attached() const noexcept;

  Result<void> plug() override;
  Result<void> unplug() override;
  [[nodiscard]] bool is_plugged() const noexcept override { return is_plugged_; }
  [[nodiscard]] bool is_open() const noexcept override;
  [[nodiscard]] bool is_broken() const noexcept override { return false; }
  [[nodiscard]] PlugCounters counters() const noexcept override;

 private:
  using Tcp = boost::asio::ip::tcp;
  struct Connection {
    Tcp::socket socket;
    UsbipSession session;
    MonotonicTime answered_at{};  // or accepted; a byte now and then is no question
    std::size_t sent{0};          // of the session's outbox
  };
  UsbipPlug(boost::asio::io_context& io, plugin::SimUsbModel& model, UsbPersona persona,
            const PlugSurroundings& surroundings);

  void fire(MonotonicTime now) noexcept override;
  void accept(MonotonicTime now);
  [[nodiscard]] static bool is_idle(const Connection& connection, MonotonicTime now) noexcept;
  [[nodiscard]] static bool is_over(Connection& connection) noexcept;
  [[nodiscard]] bool receive(Connection& connection);
  [[nodiscard]] bool send(Connection& connection);
  void drop(std::list<Connection>::iterator connection);

  plugin::SimUsbModel* model_;
  UsbPersona persona_;
  PlugSurroundings around_;
  unsigned rounds_per_frame_;
  std::uint64_t round_{0};
  MonotonicTime left_out_until_{};
  bool is_plugged_{false};
  bool was_unplugged_{false};
  boost::asio::io_context* io_;
  Tcp::acceptor acceptor_;
  std::list<Connection> connections_;
  PlugCounters closed_{};  // of connections that are gone
};

}  // namespace thimble::sim
