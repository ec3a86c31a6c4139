#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "hal/linux/hid_address.hpp"

// Whatever devices say is their serial number: places that differ have addresses that differ, each
// a word of its own that a configuration can hold. Of each device: one byte of port, one of
// interface and of whether it is an arm, and its serial number up to a zero.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thimble;
  std::vector<linux::DevicePlace> places;
  std::set<std::pair<std::string, unsigned>> where;
  std::size_t at = 0;
  while (at + 2 <= size && places.size() < 32) {
    linux::DevicePlace place;
    place.port = "1-" + std::to_string(data[at] % 16) + (data[at] < 128 ? "" : ".2");
    place.interface_number = data[at + 1] % 4;
    place.is_arm = data[at + 1] >= 128;
    for (at += 2; at < size && data[at] != 0; ++at) {
      place.serial_number += static_cast<char>(data[at]);
    }
    ++at;
    if (where.emplace(place.port, place.interface_number).second) places.push_back(place);
  }
  std::set<std::string> addresses;
  for (const bus::DeviceAddress& address : linux::hid_addresses(places)) {
    if (!addresses.insert(address.text).second) std::abort();
    if (!address.text.starts_with("hid:") || address.text.size() > 80) std::abort();
    const auto is_plain = [](char c) { return c > ' ' && c <= '~'; };
    if (!std::all_of(address.text.begin(), address.text.end(), is_plain)) std::abort();
  }
  return 0;
}
