#pragma once

#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <list>
#include <vector>

#include "hal/base/result.hpp"
#include "hal/plugin/sim_usb_model.hpp"
#include "sim/export/plug.hpp"
#include "sim/export/usbip_session.hpp"
#include "sim/time/event_queue.hpp"

namespace thimble::sim {

// A simulated USB device that hosts have over sockets which carry USB/IP, however they came by
// them: what UsbipPlug and VhciPlug have in common.
//
// Runs the rounds of the device's bus on the model's clock, and looks at its sockets there, without
// waiting; between two of them wait_for_kernel() reads what comes. One host has the device at a
// time. Unplugged the connections close, which pulls the cable on the other side. A device with
// bulk pipes has eight rounds in a frame, as SimUsbPort; one with interrupt pipes alone needs but
// one.
//
// Thread, Errors: as Plug. RT: none of it. Ownership: model and surroundings must outlive it, and
// the io_context of its sockets.
class UsbipBus : public Plug, private Event {
 public:
  static constexpr std::size_t kMostConnections = 4;  // ours: one host, and `usbip list` beside it
  // Who asks nothing for so long, or takes the device and makes no request of it, or takes nothing
  // of what it asked for, holds a place that others want, and is hung up on. Ours: a kernel asks
  // for descriptors within 1 s, and reads whatever comes. A host that has it may be idle for ever.
  static constexpr Duration kPatience = std::chrono::seconds(10);

  // A host has it; whether somebody there uses it, is_open() says.
  [[nodiscard]] bool is_attached() const noexcept;

  Result<void> plug() final;
  Result<void> unplug(Supply supply) override;
  [[nodiscard]] bool is_plugged() const noexcept override { return is_plugged_; }
  [[nodiscard]] bool is_open() const noexcept override;
  [[nodiscard]] bool is_broken() const noexcept override { return false; }
  [[nodiscard]] bool has_endpoints() const noexcept override { return true; }
  [[nodiscard]] PlugCounters counters() const noexcept override;
  [[nodiscard]] Duration round_period() const noexcept override;
  [[nodiscard]] MonotonicTime next_needed() const noexcept override;
  [[nodiscard]] bool wait_for_kernel(MonotonicTime until) noexcept override;
  void advance_model(MonotonicTime t) noexcept override { model_->advance(t); }
  void leave_out_until(MonotonicTime t) noexcept override { left_out_until_ = t; }

 protected:
  using Socket = boost::asio::generic::stream_protocol::socket;  // of any family
  UsbipBus(plugin::SimUsbModel& model, UsbPersona persona, const PlugSurroundings& surroundings);
  // Whoever has to be told that it is plugged in; an error leaves it unplugged.
  virtual Result<void> tell_host() = 0;
  // `socket`: does not block.
  UsbipSession& connect(Socket socket);
  // For one more, at the end of a round, of the 4 that may be connected (kMostConnections). Where
  // every place is taken it hangs up on the one that has asked nothing for the longest, whose
  // session ends; false: all of them have the device or are being answered.
  [[nodiscard]] bool make_room();
  // The rounds of a frame are over, the number of it.
  virtual void end_frame(std::uint64_t frame) noexcept = 0;

 private:
  struct Connection {
    Socket socket;
    UsbipSession session;
    MonotonicTime answered_at{};  // or accepted; a byte now and then is no question
    MonotonicTime taken_at{};     // something of the outbox, or there was nothing in it
    std::size_t sent{0};          // of the session's outbox
    bool is_up{true};             // false: it has to be dropped
    bool is_sound{true};          // false: what it said is no message
  };
  void fire(MonotonicTime now) noexcept override;
  // False: the connection has to be dropped.
  [[nodiscard]] bool run_round(Connection& connection, MonotonicTime now);
  // Waits until then, on the machine's clock, at the longest; true also of a connection that ended.
  [[nodiscard]] bool has_word_from_kernel(MonotonicTime until) noexcept;
  [[nodiscard]] static bool is_idle(const Connection& connection, MonotonicTime now) noexcept;
  [[nodiscard]] static bool is_over(Connection& connection) noexcept;
  // What came is taken, nothing is served; `is_up` tells of the connection afterwards.
  void receive(Connection& connection, MonotonicTime now);
  [[nodiscard]] static bool read(Connection& connection);
  [[nodiscard]] static bool send(Connection& connection, MonotonicTime now);
  void drop(std::list<Connection>::iterator connection);

  plugin::SimUsbModel* model_;
  UsbPersona persona_;
  PlugSurroundings around_;
  unsigned rounds_per_frame_;
  std::uint64_t round_{0};
  MonotonicTime left_out_until_{};
  bool is_plugged_{false};
  bool has_no_supply_{false};  // made with it
  std::list<Connection> connections_;
  PlugCounters closed_{};  // of connections that are gone
};

}  // namespace thimble::sim
