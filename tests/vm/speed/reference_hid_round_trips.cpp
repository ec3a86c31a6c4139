#include <hidapi/hidapi.h>

#include <chrono>
#include <cstring>

#include "tests/vm/speed/reference_round_trips.hpp"

std::vector<double> reference_hid_round_trips(const char* path, std::size_t round_trips) {
  hid_device* device = hid_open_path(path);
  if (device == nullptr) return {};
  std::vector<double> trips_s;
  unsigned char sent[17] = {};  // no report number, and 16 bytes
  unsigned char answer[64] = {};
  for (std::size_t i = 1; i <= round_trips; ++i) {
    std::memcpy(sent + 1, &i, sizeof i);
    const auto begin = std::chrono::steady_clock::now();
    bool is_back = hid_write(device, sent, sizeof sent) == sizeof sent;
    while (is_back && std::memcmp(answer, sent + 1, 16) != 0) {
      is_back = hid_read_timeout(device, answer, sizeof answer, 5000) == 16;
    }
    const auto end = std::chrono::steady_clock::now();
    if (!is_back) break;
    trips_s.push_back(std::chrono::duration<double>(end - begin).count());
  }
  hid_close(device);
  if (trips_s.size() < round_trips) trips_s.clear();
  return trips_s;
}
