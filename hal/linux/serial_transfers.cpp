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

namespace thimble::linux {
namespace {

constexpr int kForEver = -1;
constexpr int kLook_ms = 1;     // how often we look whether the kernel is done with a message
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
  for (std::size_t i = 0; i < bus::kUsbQueuedPackets && !mail_->is_disconnected(); ++i) {
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

SerialTransfers::Ready SerialTransfers::wait(int event) const noexcept {
  const bool is_gone = mail_->is_disconnected();  // and would be readable for ever
  const short wanted = left_ == Left::Room ? POLLIN | POLLOUT : POLLIN;
  std::array<pollfd, 2> watched{{{event, POLLIN, 0}, {is_gone ? -1 : node_.get(), wanted, 0}}};
  const int ready =
      ::poll(watched.data(), watched.size(), left_ == Left::Earlier ? kLook_ms : kForEver);
  if (ready <= 0) return {};
  return {.is_woken = watched[0].revents != 0, .has_bytes = (watched[1].revents & ~POLLOUT) != 0};
}

void SerialTransfers::send_last() noexcept {
  for (int i = 0; i < kLastLooks; ++i) {
    const bool is_sent = send();
    if (mail_->is_disconnected() || (is_sent && is_kernel_done())) return;
    pollfd room{node_.get(), 0, 0};
    if (left_ == Left::Room) room.events = POLLOUT;
    ::poll(&room, 1, kLook_ms);
  }
}

}  // namespace thimble::linux
