#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "hal/base/check.hpp"
#include "hal/linux/hid_address.hpp"
#include "hal/linux/usb_path.hpp"

namespace {

using namespace thimble;

// A device of USB has its port for a name, another one what the kernel calls it.
std::string port_of(std::uint8_t byte) {
  const std::string number = std::to_string(byte % 16);
  if (byte >= 192) return "0003:1234:0006.00" + number;
  return "1-" + number + (byte < 128 ? "" : ".2");
}

// Of two controllers, or none: two ports may have one path.
std::string path_of(std::uint8_t byte) {
  if (byte % 4 == 0) return {};
  return std::string(byte < 16 ? "pci-0000:00:14.0-usb" : "platform-soc-usb") +
         (byte % 4 == 1 ? "v3" : "") + "-0:1." + std::to_string(byte % 16);
}

void require_addresses(const std::vector<bus::DeviceAddress>& all, const std::string& scheme,
                       const std::vector<linux::DevicePlace>& places) {
  THIMBLE_CHECK(all.size() == places.size());
  std::set<std::string> addresses;
  for (const bus::DeviceAddress& address : all) {
    THIMBLE_CHECK(addresses.insert(address.text).second);
    THIMBLE_CHECK(address.text.starts_with(scheme) &&
                  address.text.size() <= linux::kMaxUsbPathLetters + 13);
    const auto is_plain = [](char c) { return c > ' ' && c <= '~'; };
    THIMBLE_CHECK(std::all_of(address.text.begin(), address.text.end(), is_plain));
  }
}

// The number of an arm is its own, whoever else says it (decision 0338).
void require_that_arms_keep_their_numbers(const std::vector<bus::DeviceAddress>& all,
                                          const std::vector<linux::DevicePlace>& places) {
  std::map<std::string, std::set<std::string>> arms;  // ports by number
  for (const auto& place : places) {
    if (place.is_arm) arms[place.serial_number].insert(place.port);
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::string& number = places[i].serial_number;
    if (!places[i].is_arm || !linux::is_usable_serial(number)) continue;
    if (arms[number].size() > 1) continue;
    // Another interface at the arm's port may say that number, too, and be none: it is the arm's.
    const bool is_shared = std::any_of(places.begin(), places.end(), [&](const auto& other) {
      return other.serial_number == number && other.port != places[i].port &&
             std::any_of(places.begin(), places.end(), [&](const auto& at_its_port) {
               return at_its_port.port == other.port && at_its_port.is_arm;
             });
    });
    if (!is_shared) THIMBLE_CHECK(all[i].text.find(":" + number) != std::string::npos);
  }
}

}  // namespace

// Whatever devices say is their serial number: places that differ have addresses that differ, each
// a word of its own that a configuration can hold, and no stranger takes an arm's. Of each device:
// one byte of port, one of interface, path and of whether it is an arm, and its serial number up to
// a zero.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<linux::DevicePlace> places;
  std::set<std::pair<std::string, unsigned>> where;
  std::size_t at = 0;
  while (at + 2 <= size && places.size() < 32) {
    linux::DevicePlace place;
    place.port = port_of(data[at]);
    place.interface_number = data[at + 1] % 4;
    place.is_arm = data[at + 1] >= 128;
    place.path = path_of(static_cast<std::uint8_t>(data[at + 1] / 4 % 32));
    for (at += 2; at < size && data[at] != 0; ++at) {
      place.serial_number += static_cast<char>(data[at]);
    }
    ++at;
    if (where.emplace(place.port, place.interface_number).second) places.push_back(place);
  }
  const std::vector<bus::DeviceAddress> hid = linux::hid_addresses(places);
  require_addresses(hid, "hid:", places);
  require_addresses(linux::serial_addresses(places), "serial:", places);
  require_addresses(linux::usb_addresses(places), "usb:", places);
  require_that_arms_keep_their_numbers(hid, places);
  return 0;
}
