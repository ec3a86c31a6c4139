#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

#include <cstddef>
#include <cstring>

#include "tests/vm/speed/reference_round_trips.hpp"

namespace {

bool make_raw(int port) {
  termios settings = {};
  if (tcgetattr(port, &settings) != 0) return false;
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cc[VMIN] = 0;
  settings.c_cc[VTIME] = 50;  // 5 s
  return tcsetattr(port, TCSANOW, &settings) == 0 && tcflush(port, TCIOFLUSH) == 0;
}

bool read_whole(int port, unsigned char* answer, std::size_t bytes) {
  for (std::size_t size = 0; size < bytes;) {
    const ssize_t got = read(port, answer + size, bytes - size);
    if (got <= 0) return false;
    size += static_cast<std::size_t>(got);
  }
  return true;
}

}  // namespace

std::optional<RoundTripFigures> reference_serial_round_trips(const ReferenceNodes& nodes,
                                                             std::size_t round_trips) {
  const int port = open(nodes.node, O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (port < 0) return std::nullopt;
  std::optional<RoundTripFigures> figures;
  unsigned char sent[16] = {};
  unsigned char answer[16] = {};
  const auto prepare = [&](std::size_t number) {
    std::memcpy(sent, &number, sizeof number);
    return true;
  };
  if (make_raw(port)) {
    figures = measured(round_trips, prepare, [&] {
      return write(port, sent, sizeof sent) == sizeof sent &&
             read_whole(port, answer, sizeof answer) && std::memcmp(answer, sent, sizeof sent) == 0;
    });
  }
  close(port);
  return figures;
}
