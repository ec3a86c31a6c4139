#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

#include <chrono>
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

std::vector<double> reference_serial_round_trips(const char* path, std::size_t round_trips) {
  const int port = open(path, O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (port < 0) return {};
  std::vector<double> trips_s;
  unsigned char sent[16] = {};
  unsigned char answer[16] = {};
  bool is_back = make_raw(port);
  for (std::size_t i = 1; is_back && i <= round_trips; ++i) {
    std::memcpy(sent, &i, sizeof i);
    const auto begin = std::chrono::steady_clock::now();
    is_back = write(port, sent, sizeof sent) == sizeof sent &&
              read_whole(port, answer, sizeof answer) &&
              std::memcmp(answer, sent, sizeof sent) == 0;
    const auto end = std::chrono::steady_clock::now();
    if (is_back) trips_s.push_back(std::chrono::duration<double>(end - begin).count());
  }
  close(port);
  if (trips_s.size() < round_trips) trips_s.clear();
  return trips_s;
}
