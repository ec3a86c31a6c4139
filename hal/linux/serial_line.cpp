#include "hal/linux/serial_line.hpp"

#include <fcntl.h>
#include <linux/serial.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <optional>
#include <utility>

#include "hal/linux/system_error.hpp"

namespace thimble::linux {
namespace {

constexpr const char* kLineRefused = " cannot be opened";

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

Result<void> set_up(int file, const std::string& node, const bus::SerialLine& line) {
  const std::optional<speed_t> speed = speed_of(line.bit_per_s);
  if (!speed) {
    return fail(Errc::InvalidArgument,
                node + ": no line of " + std::to_string(line.bit_per_s) + " bit/s");
  }
  termios settings{};
  if (::ioctl(file, TIOCEXCL) != 0 || ::tcgetattr(file, &settings) != 0) {
    return tl::unexpected(system_error(node + " is no terminal", errno));
  }
  ::cfmakeraw(&settings);
  settings.c_iflag = 0;  // IXOFF, IXANY and INPCK would stay as whoever had it before left them
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB);
  settings.c_cc[VMIN] = 1;  // so that no byte there is EAGAIN, and 0 bytes the end
  settings.c_cc[VTIME] = 0;
  ::cfsetspeed(&settings, *speed);
  if (::tcsetattr(file, TCSANOW, &settings) != 0) {
    return tl::unexpected(system_error(node + " cannot be set up", errno));
  }
  ask_for_low_latency(file);
  static_cast<void>(::tcflush(file, TCIOFLUSH));
  return {};
}

struct Held {
  explicit Held(Descriptor opened) noexcept : node(std::move(opened)), file(node.get()) {}
  ~Held() { let_go_of_serial_line(file); }
  Held(const Held&) = delete;
  Held& operator=(const Held&) = delete;
  Descriptor node;
  int file;
};

}  // namespace

Result<Descriptor> open_serial_line(const std::string& node, const bus::SerialLine& line) {
  Descriptor opened(::open(node.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (opened.get() < 0) return tl::unexpected(system_error(node + kLineRefused, errno));
  if (::flock(opened.get(), LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) return tl::unexpected(system_error(node + kLineRefused, errno));
    return fail(Errc::Busy, node + " is held by another daemon, or locked by another program");
  }
  const Result<void> ready = set_up(opened.get(), node, line);
  if (!ready) {
    let_go_of_serial_line(opened.get());
    return tl::unexpected(ready.error());
  }
  return opened;
}

void let_go_of_serial_line(int node) noexcept {
  static_cast<void>(::tcflush(node, TCOFLUSH));
  static_cast<void>(::ioctl(node, TIOCNXCL));
  static_cast<void>(::flock(node, LOCK_UN));
}

Result<std::shared_ptr<const int>> share_serial_line(const std::string& node,
                                                     std::uint32_t bit_per_s) {
  Result<Descriptor> opened = open_serial_line(node, {bit_per_s});
  if (!opened) return tl::unexpected(opened.error());
  auto held = std::make_shared<const Held>(*std::move(opened));
  return std::shared_ptr<const int>(held, &held->file);
}

}  // namespace thimble::linux
