#include "hal/linux/serial_transfers.hpp"

#include <fcntl.h>
#include <linux/serial.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <optional>
#include <utility>

#include "hal/linux/system_error.hpp"

namespace thimble::linux {
namespace {

constexpr const char* kRefused = " cannot be opened";
constexpr int kForEver = -1;
constexpr int kLook_ms = 1;  // how often we look whether the kernel is done with a message
constexpr int kLastLooks = 20;

// Those of POSIX and Linux from 9600 on; a Teensy takes 134 for "start your boot-loader".
std::optional<speed_t> speed_of(std::uint32_t bit_per_s) noexcept {
  struct Speed {
    std::uint32_t bit_per_s;
    speed_t code;
  };
  constexpr std::array<Speed, 18> kSpeeds{{{9600, B9600},
                                           {19200, B19200},
                                           {38400, B38400},
                                           {57600, B57600},
                                           {115200, B115200},
                                           {230400, B230400},
                                           {460800, B460800},
                                           {500000, B500000},
                                           {576000, B576000},
                                           {921600, B921600},
                                           {1000000, B1000000},
                                           {1152000, B1152000},
                                           {1500000, B1500000},
                                           {2000000, B2000000},
                                           {2500000, B2500000},
                                           {3000000, B3000000},
                                           {3500000, B3500000},
                                           {4000000, B4000000}}};
  for (const Speed& speed : kSpeeds) {
    if (speed.bit_per_s == bit_per_s) return speed.code;
  }
  return std::nullopt;
}

// An adapter's chip then hands bytes over at once. Not every terminal has it, and none needs it.
void ask_for_low_latency(int node) noexcept {
  serial_struct settings{};
  if (::ioctl(node, TIOCGSERIAL, &settings) != 0) return;
  settings.flags |= static_cast<int>(ASYNC_LOW_LATENCY);
  static_cast<void>(::ioctl(node, TIOCSSERIAL, &settings));
}

}  // namespace

Result<std::unique_ptr<SerialTransfers>> SerialTransfers::open(const std::string& node,
                                                               const bus::SerialLine& line,
                                                               bus::SerialMailboxes& mail,
                                                               const Clock& clock,
                                                               DeviceCalls& calls) {
  Descriptor opened(::open(node.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (opened.get() < 0) return tl::unexpected(system_error(node + kRefused, errno));
  if (::flock(opened.get(), LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) return tl::unexpected(system_error(node + kRefused, errno));
    return fail(Errc::Busy, node + " is held by another daemon");
  }
  std::unique_ptr<SerialTransfers> transfers(
      new SerialTransfers(std::move(opened), mail, clock, calls));
  const Result<void> ready = transfers->set_up(node, line);
  if (!ready.has_value()) return tl::unexpected(ready.error());
  return transfers;
}

Result<void> SerialTransfers::set_up(const std::string& node, const bus::SerialLine& line) {
  const std::optional<speed_t> speed = speed_of(line.bit_per_s);
  if (!speed) {
    return fail(Errc::InvalidArgument,
                node + ": no line of " + std::to_string(line.bit_per_s) + " bit/s");
  }
  termios settings{};
  if (::ioctl(node_.get(), TIOCEXCL) != 0 || ::tcgetattr(node_.get(), &settings) != 0) {
    return tl::unexpected(system_error(node + " is no terminal", errno));
  }
  ::cfmakeraw(&settings);
  settings.c_iflag = 0;  // IXOFF, IXANY and INPCK would stay as whoever had it before left them
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB);
  settings.c_cc[VMIN] = 1;  // so that no byte there is EAGAIN, and 0 bytes the end
  settings.c_cc[VTIME] = 0;
  ::cfsetspeed(&settings, *speed);
  if (::tcsetattr(node_.get(), TCSANOW, &settings) != 0) {
    return tl::unexpected(system_error(node + " cannot be set up", errno));
  }
  ask_for_low_latency(node_.get());
  static_cast<void>(::tcflush(node_.get(), TCIOFLUSH));
  return {};
}

// Who shares the node must not keep the next opener out, nor make the kernel wait with what it has.
SerialTransfers::~SerialTransfers() {
  static_cast<void>(::tcflush(node_.get(), TCOFLUSH));
  static_cast<void>(::ioctl(node_.get(), TIOCNXCL));
  static_cast<void>(::flock(node_.get(), LOCK_UN));
}

void SerialTransfers::fail_unless_later() noexcept {
  if (errno != EAGAIN && errno != EINTR) mail_->disconnect();
}

void SerialTransfers::receive() noexcept {
  std::array<std::uint8_t, bus::kMaxSerialBytes> buffer;
  for (std::size_t i = 0; i < bus::kUsbQueuedPackets && !mail_->is_disconnected(); ++i) {
    const ssize_t bytes = ::read(node_.get(), buffer.data(), buffer.size());
    if (bytes < 0) return fail_unless_later();
    if (bytes == 0) return mail_->disconnect();  // hung up
    mail_->deliver(std::span(buffer).first(static_cast<std::size_t>(bytes)), clock_->now());
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
    if (!mail_->is_out_begun() && !is_kernel_done()) {
      left_ = Left::Earlier;
      return false;
    }
    const std::span<const std::uint8_t> rest = mail_->take_out();
    if (rest.empty()) return true;
    const ssize_t bytes = calls_->write(node_.get(), rest);
    if (bytes <= 0) {
      if (bytes < 0) fail_unless_later();
      left_ = Left::Room;
      return false;
    }
    mail_->sent_out(static_cast<std::size_t>(bytes));
  }
  return true;
}

void SerialTransfers::wait(int event) const noexcept {
  const bool is_gone = mail_->is_disconnected();  // and would be readable for ever
  const short wanted = left_ == Left::Room ? POLLIN | POLLOUT : POLLIN;
  std::array<pollfd, 2> watched{{{event, POLLIN, 0}, {is_gone ? -1 : node_.get(), wanted, 0}}};
  ::poll(watched.data(), watched.size(), left_ == Left::Earlier ? kLook_ms : kForEver);
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
