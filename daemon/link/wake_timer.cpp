#include "daemon/link/wake_timer.hpp"

#include <boost/asio/error.hpp>
#include <utility>

namespace thimble::link {

WakeTimer::WakeTimer(boost::asio::io_context& io) : timer_(io), alive_(std::make_shared<Alive>()) {}

void WakeTimer::start(std::function<void()> on_timer) { alive_->on_timer = std::move(on_timer); }

void WakeTimer::wake_after(MonotonicTime now, Duration wait) {
  std::optional<MonotonicTime>& wakes_at = alive_->wakes_at;
  if (wakes_at && *wakes_at <= now + wait) return;  // re-arming costs a system call
  wakes_at = now + wait;
  timer_.expires_after(wait);
  timer_.async_wait([alive = std::weak_ptr<Alive>(alive_)](const boost::system::error_code& error) {
    const std::shared_ptr<Alive> held = alive.lock();
    if (!held || error == boost::asio::error::operation_aborted) return;
    held->wakes_at.reset();
    held->on_timer();
  });
}

}  // namespace thimble::link
