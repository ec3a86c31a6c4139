#include "daemon/link/tty_port.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>
#include <utility>

namespace thimble::link {

namespace asio = boost::asio;
using boost::system::error_code;

TtyPort::TtyPort(asio::io_context& io, Open open)
    : line_(io),
      timer_(io),
      open_timer_(io),
      open_(std::move(open)),
      alive_(std::make_shared<Alive>()) {}

TtyPort::~TtyPort() {
  if (line_.is_open()) line_.release();  // node_ closes it
}

void TtyPort::start(Handlers handlers) {
  timer_.start(handlers.on_timer);
  alive_->handlers = std::move(handlers);
  open();
}

void TtyPort::open() {
  Result<LineNode> node = open_();
  if (!node) {
    last_error_ = node.error().message;
    return open_later();
  }
  node_ = *std::move(node);
  error_code error;
  line_.assign(*node_, error);
  if (error) return close("cannot be watched: " + error.message());
  last_error_.clear();
  receive_next();
  alive_->handlers.on_timer();
}

void TtyPort::close(const std::string& why) {
  last_error_ = why;
  if (line_.is_open()) line_.release();
  node_.reset();
  is_writing_ = false;
  open_later();
}

void TtyPort::open_later() {
  open_timer_.expires_after(kOpenAgain);
  open_timer_.async_wait([this, alive = std::weak_ptr<Alive>(alive_)](const error_code& error) {
    const std::shared_ptr<Alive> held = alive.lock();
    if (!held || error == asio::error::operation_aborted) return;
    open();
  });
}

void TtyPort::receive_next() {
  line_.async_read_some(asio::buffer(buffer_),
                        [this, of = node_, alive = std::weak_ptr<Alive>(alive_)](
                            const error_code& error, std::size_t size) {
                          const std::shared_ptr<Alive> held = alive.lock();
                          if (!held || of != node_ || error == asio::error::operation_aborted)
                            return;
                          if (error) return close("the line is gone: " + error.message());
                          held->handlers.on_bytes(std::span<const std::byte>(buffer_).first(size));
                          if (held.use_count() > 1 && of == node_) receive_next();
                        });
}

void TtyPort::send(const SerialFrame& frame) {
  leaving_ = std::make_shared<const SerialFrame>(frame);
  is_writing_ = true;
  asio::async_write(line_, asio::buffer(leaving_->bytes.data(), leaving_->size),
                    [this, of = node_, bytes = leaving_, alive = std::weak_ptr<Alive>(alive_)](
                        const error_code& error, std::size_t) {
                      const std::shared_ptr<Alive> held = alive.lock();
                      if (!held || of != node_ || error == asio::error::operation_aborted) return;
                      if (error) return close("the line is gone: " + error.message());
                      is_writing_ = false;
                      held->handlers.on_timer();
                    });
}

void TtyPort::wake_after(MonotonicTime now, Duration wait) { timer_.wake_after(now, wait); }

}  // namespace thimble::link
