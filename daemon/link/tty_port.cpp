#include "daemon/link/tty_port.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>
#include <utility>

namespace thimble::link {

namespace asio = boost::asio;
using boost::system::error_code;

// For the answer to an opening that lasts: ours, no more than a frame's way at the slowest rate.
constexpr Duration kLookAgain = std::chrono::milliseconds(20);

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
  opening_ = open_();
  look_for_answer();
}

void TtyPort::look_for_answer() {
  if (opening_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
    return after(kLookAgain, &TtyPort::look_for_answer);
  }
  try {
    use(opening_.get());
  } catch (const std::future_error&) {
    use(fail(Errc::System, "who opens the line gave it up"));
  }
}

void TtyPort::use(Result<LineNode> node) {
  if (!node) {
    last_error_ = node.error().message;
    return after(kOpenAgain, &TtyPort::open);
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
  ++generation_;
  is_writing_ = false;
  after(kOpenAgain, &TtyPort::open);
}

void TtyPort::after(Duration wait, void (TtyPort::*then)()) {
  open_timer_.expires_after(wait);
  open_timer_.async_wait(
      [this, then, alive = std::weak_ptr<Alive>(alive_)](const error_code& error) {
        const std::shared_ptr<Alive> held = alive.lock();
        if (!held || error == asio::error::operation_aborted) return;
        (this->*then)();
      });
}

void TtyPort::receive_next() {
  line_.async_read_some(asio::buffer(buffer_),
                        [this, of = generation_, alive = std::weak_ptr<Alive>(alive_)](
                            const error_code& error, std::size_t size) {
                          const std::shared_ptr<Alive> held = alive.lock();
                          if (!held || of != generation_ || error == asio::error::operation_aborted)
                            return;
                          if (error) return close("the line is gone: " + error.message());
                          held->handlers.on_bytes(std::span<const std::byte>(buffer_).first(size));
                          if (held.use_count() > 1 && of == generation_) receive_next();
                        });
}

void TtyPort::send(const SerialFrame& frame) {
  leaving_ = std::make_shared<const SerialFrame>(frame);
  is_writing_ = true;
  asio::async_write(line_, asio::buffer(leaving_->bytes.data(), leaving_->size),
                    [this, of = generation_, bytes = leaving_,
                     alive = std::weak_ptr<Alive>(alive_)](const error_code& error, std::size_t) {
                      const std::shared_ptr<Alive> held = alive.lock();
                      if (!held || of != generation_ || error == asio::error::operation_aborted)
                        return;
                      if (error) return close("the line is gone: " + error.message());
                      is_writing_ = false;
                      held->handlers.on_timer();
                    });
}

void TtyPort::wake_after(MonotonicTime now, Duration wait) { timer_.wake_after(now, wait); }

}  // namespace thimble::link
