#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <memory>
#include <optional>

#include "hal/base/time.hpp"

namespace thimble::link {

// The timer of a port: see LinePort, DatagramPort. Includes Asio: only for .cpp files of this
// folder.
//
// Thread: the one that runs the io_context, which must outlive it. What start() was given may
// destroy it, and never runs afterwards. Errors: none.
class WakeTimer {
 public:
  explicit WakeTimer(boost::asio::io_context& io);
  void start(std::function<void()> on_timer);  // once, before it can be due
  // After `wait`, or earlier when that was asked for before.
  void wake_after(MonotonicTime now, Duration wait);

 private:
  // Shared with what Asio still holds when the timer is gone: it looks here whether it is.
  struct Alive {
    std::function<void()> on_timer;
    std::optional<MonotonicTime> wakes_at;
  };

  boost::asio::steady_timer timer_;
  std::shared_ptr<Alive> alive_;
};

}  // namespace thimble::link
