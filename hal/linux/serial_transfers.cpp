#include "hal/linux/serial_transfers.hpp"

#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "hal/linux/serial_line.hpp"
#include "hal/linux/timespec.hpp"

namespace thimble::linux {
namespace {

// How often we look whether the kernel is done with a message.
constexpr Duration kLook = std::chrono::milliseconds(1);
constexpr int kLastLooks = 20;  // ours: a device that takes a message has it by then

}  // namespace

Result<std::unique_ptr<SerialTransfers>> SerialTransfers::open(const std::string& node,
                                                               const bus::SerialLine& line,
                                                               bus::SerialMailboxes& mail,
                                                               const Clock& clock,
                                                               DeviceCalls& calls) {
  Result<Descriptor> opened = open_serial_line(node, line);
  if (!opened) return tl::unexpected(opened.error());
  return std::unique_ptr<SerialTransfers>(
      new SerialTransfers(*std::move(opened), mail, clock, calls));
}

SerialTransfers::~SerialTransfers() { let_go_of_serial_line(node_.get()); }

void SerialTransfers::fail_unless_later() noexcept {
  if (errno != EAGAIN && errno != EINTR) mail_->disconnect();
}

void SerialTransfers::receive() noexcept {
  std::array<std::uint8_t, bus::kMaxSerialBytes> buffer;
  if (reads_ == 0 || clock_->now() - first_read_ >= kReadWindow) {
    first_read_ = clock_->now();
    reads_ = 0;
  }
  while (reads_ < kMostReads && !mail_->is_disconnected()) {
    ++reads_;
    const ssize_t bytes = ::read(node_.get(), buffer.data(), buffer.size());
    if (bytes < 0) return fail_unless_later();
    if (bytes == 0) return mail_->disconnect();  // hung up
    const auto size = static_cast<std::size_t>(bytes);
    mail_->deliver(std::span(buffer).first(size), clock_->now());
    if (size < buffer.size()) return;  // that was all; to be told so would take another call
  }
}

// Of a terminal that cannot tell: yes.
bool SerialTransfers::is_kernel_done() const noexcept {
  int bytes = 0;
  return calls_->control(node_.get(), TIOCOUTQ, &bytes) != 0 || bytes == 0;
}

bool SerialTransfers::send() noexcept {
  left_ = Left::Nothing;
  while (!mail_->is_disconnected()) {
    if (!mail_->has_out()) return true;
    if (!mail_->is_out_begun() && !is_kernel_done()) {
      left_ = Left::Earlier;
      return false;
    }
    const ssize_t bytes = calls_->write(node_.get(), mail_->take_out());
    if (bytes <= 0) {
      if (bytes < 0) fail_unless_later();
      left_ = Left::Room;
      return false;
    }
    mail_->sent_out(static_cast<std::size_t>(bytes));
  }
  return true;
}

Duration SerialTransfers::rest() const noexcept {
  if (reads_ < kMostReads) return Duration::zero();
  return std::max(Duration::zero(), first_read_ + kReadWindow - clock_->now());
}

SerialTransfers::Ready SerialTransfers::wait(int event) const noexcept {
  const Duration resting = rest();
  const bool is_read = resting == Duration::zero();
  const short wanted =
      static_cast<short>((is_read ? POLLIN : 0) | (left_ == Left::Room ? POLLOUT : 0));
  // One that is gone would be readable for ever.
  const bool is_watched = !mail_->is_disconnected() && wanted != 0;
  std::array<pollfd, 2> watched{{{event, POLLIN, 0}, {is_watched ? node_.get() : -1, wanted, 0}}};
  const Duration look = left_ == Left::Earlier ? kLook : Duration::max();
  const Duration patience = is_read ? look : std::min(look, resting);
  const timespec most = to_timespec(patience);
  const int ready = ::ppoll(watched.data(), watched.size(),
                            patience == Duration::max() ? nullptr : &most, nullptr);
  if (ready <= 0) return {};
  return {.is_woken = watched[0].revents != 0, .has_bytes = (watched[1].revents & ~POLLOUT) != 0};
}

void SerialTransfers::send_last() noexcept {
  for (int i = 0; i < kLastLooks; ++i) {
    const bool is_sent = send();
    if (mail_->is_disconnected() || (is_sent && is_kernel_done())) return;
    pollfd room{node_.get(), 0, 0};
    if (left_ == Left::Room) room.events = POLLOUT;
    const timespec most = to_timespec(kLook);
    ::ppoll(&room, 1, &most, nullptr);
  }
}

}  // namespace thimble::linux
