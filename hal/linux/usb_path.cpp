#include "hal/linux/usb_path.hpp"

#include <optional>

#include "hal/bus/device_name.hpp"

// Names: Documentation/ABI/{stable,testing}/sysfs-bus-usb of the kernel, usb_alloc_dev() in its
// drivers/usb/core/usb.c, pci_setup_device() and pci_create_root_bus() in drivers/pci/probe.c.
namespace thimble::linux {
namespace {

constexpr std::string_view kDevices = "/sys/devices/";
constexpr std::string_view kDecimal = "0123456789";
constexpr std::string_view kHexadecimal = "0123456789abcdef";

bool is_all_of(std::string_view text, std::string_view letters) {
  return !text.empty() && text.find_first_not_of(letters) == std::string_view::npos;
}

// Up to `letter`, without which it is all; what is left begins behind that.
std::string_view take_until(char letter, std::string_view& left) {
  const std::string_view first = left.substr(0, left.find(letter));
  left.remove_prefix(first.size() < left.size() ? first.size() + 1 : first.size());
  return first;
}

// "0000:00:14.0", with a domain of any length.
bool is_pci_function(std::string_view name) {
  constexpr std::size_t kTail = 8;  // ":00:14.0"
  if (name.size() <= kTail || !is_all_of(name.substr(0, name.size() - kTail), kHexadecimal)) {
    return false;
  }
  const std::string_view tail = name.substr(name.size() - kTail);
  return tail[0] == ':' && is_all_of(tail.substr(1, 2), kHexadecimal) && tail[3] == ':' &&
         is_all_of(tail.substr(4, 2), kHexadecimal) && tail[6] == '.' &&
         is_all_of(tail.substr(7), kHexadecimal);
}

// "pci0000:00", which its functions say, too.
bool is_pci_root(std::string_view name) {
  if (!name.starts_with("pci")) return false;
  name.remove_prefix(3);
  return is_all_of(take_until(':', name), kHexadecimal) && is_all_of(name, kHexadecimal);
}

// Of "pci0000:00/0000:00:1c.4/0000:05:00.0".
std::string controller_name(std::string_view way) {
  std::string name;
  bool is_below_bridge = false;
  while (!way.empty()) {
    const std::string_view step = take_until('/', way);
    const bool is_function = is_pci_function(step);
    const bool is_behind = is_function && is_below_bridge;
    is_below_bridge = is_function;
    if (step.empty() || step.ends_with(".auto") || is_pci_root(step)) continue;
    if (!name.empty()) name += '-';
    if (is_function && !is_behind) name += "pci-";
    name += is_behind ? step.substr(step.rfind(':') + 1) : step;
  }
  for (char& letter : name) {
    if (letter != ':' && bus::kSerialLetters.find(letter) == std::string_view::npos) letter = '_';
  }
  return name;
}

bool is_super_speed(std::string_view root_hub_version) {
  const std::size_t first = root_hub_version.find_first_of(kDecimal);
  return first != std::string_view::npos && root_hub_version[first] >= '3';
}

}  // namespace

std::string_view root_hub_above(std::string_view sysfs_path) {
  const std::string_view name = sysfs_path.substr(sysfs_path.rfind('/') + 1);
  const std::size_t dash = name.find('-');
  if (dash == std::string_view::npos || !is_all_of(name.substr(0, dash), kDecimal)) return {};
  const std::string hub = "/usb" + std::string(name.substr(0, dash));
  const std::size_t begin = sysfs_path.rfind(hub + "/");
  return begin == std::string_view::npos ? std::string_view{}
                                         : sysfs_path.substr(0, begin + hub.size());
}

std::string usb_path_of(std::string_view sysfs_path, std::string_view root_hub_version) {
  const std::string_view hub = root_hub_above(sysfs_path);
  if (hub.empty() || !hub.starts_with(kDevices)) return {};
  const std::string_view name = sysfs_path.substr(sysfs_path.rfind('/') + 1);
  const std::string_view ports = name.substr(name.find('-') + 1);
  if (!bus::are_usb_ports(ports)) return {};
  const std::string_view below = hub.substr(kDevices.size());
  const std::size_t end = below.rfind('/');
  const std::string way =
      controller_name(end == std::string_view::npos ? "" : below.substr(0, end));
  if (way.empty()) return {};
  std::string path = way + (is_super_speed(root_hub_version) ? "-usbv3-0:" : "-usb-0:");
  path += ports;
  return path.size() <= kMaxUsbPathLetters ? path : std::string{};
}

}  // namespace thimble::linux
