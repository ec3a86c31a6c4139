#include "hal/linux/hid_address.hpp"

#include <algorithm>
#include <string_view>

#include "hal/bus/device_name.hpp"

namespace thimble::linux {
namespace {

constexpr std::size_t kMaxSerialNumberLetters = 64;
constexpr std::string_view kDigits = "0123456789";

// "1-4", "1-4.2": what the kernel calls a USB device.
bool has_form_of_port(std::string_view text) noexcept {
  const std::size_t dash = text.find('-');
  if (dash == std::string_view::npos || dash == 0) return false;
  if (text.substr(0, dash).find_first_not_of(kDigits) != std::string_view::npos) return false;
  return text.substr(dash + 1).find_first_not_of("0123456789.") == std::string_view::npos;
}

// "platform-soc-3f980000.usb-usb-0": with an interface behind it, it would be the way to a port.
bool has_form_of_path(std::string_view text) noexcept {
  return text.ends_with("-usb-0") || text.ends_with("-usbv3-0");
}

bool has_arm(std::span<const DevicePlace> places, const std::string& port) {
  return std::any_of(places.begin(), places.end(),
                     [&](const DevicePlace& place) { return place.port == port && place.is_arm; });
}

// Whether its number or path leads to this port: nobody else has it, or this is the one arm of all
// that do.
bool has_alone(std::span<const DevicePlace> places, const DevicePlace& place,
               std::string DevicePlace::*name) {
  const bool is_arm = has_arm(places, place.port);
  return std::none_of(places.begin(), places.end(), [&](const DevicePlace& other) {
    if (other.port == place.port || other.*name != place.*name) return false;
    return !is_arm || has_arm(places, other.port);
  });
}

const std::string& name_of(std::span<const DevicePlace> places, const DevicePlace& place) {
  if (is_usable_serial(place.serial_number) &&
      has_alone(places, place, &DevicePlace::serial_number)) {
    return place.serial_number;
  }
  const bool has_path = !place.path.empty() && has_alone(places, place, &DevicePlace::path);
  return has_path ? place.path : place.port;
}

std::string with_interface(const std::string& name, const DevicePlace& place) {
  if (place.interface_number == 0) return name;
  return name + ":1." + std::to_string(place.interface_number);
}

// Of several of one interface: no serial number and no path has a colon before such a name.
std::string own_suffix(std::span<const DevicePlace> places, const DevicePlace& place) {
  const auto beside = std::count_if(places.begin(), places.end(), [&](const DevicePlace& other) {
    return other.port == place.port && other.interface_number == place.interface_number;
  });
  return beside > 1 && !place.own_name.empty() ? ":" + place.own_name : "";
}

std::vector<bus::DeviceAddress> addresses_of(std::string_view scheme,
                                             std::span<const DevicePlace> places) {
  std::vector<bus::DeviceAddress> addresses;
  for (const DevicePlace& place : places) {
    addresses.push_back({std::string(scheme) + with_interface(name_of(places, place), place) +
                         own_suffix(places, place)});
  }
  return addresses;
}

}  // namespace

bool is_usable_serial(const std::string& serial_number) noexcept {
  return !serial_number.empty() && serial_number.size() <= kMaxSerialNumberLetters &&
         serial_number.find_first_not_of(bus::kSerialLetters) == std::string::npos &&
         !has_form_of_port(serial_number) && !has_form_of_path(serial_number);
}

std::string port_name(const DevicePlace& place) { return with_interface(place.port, place); }

std::vector<bus::DeviceAddress> hid_addresses(std::span<const DevicePlace> places) {
  return addresses_of("hid:", places);
}

std::vector<bus::DeviceAddress> serial_addresses(std::span<const DevicePlace> places) {
  return addresses_of("serial:", places);
}

std::vector<bus::DeviceAddress> usb_addresses(std::span<const DevicePlace> places) {
  return addresses_of("usb:", places);
}

}  // namespace thimble::linux
