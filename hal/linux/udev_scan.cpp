#include "hal/linux/udev_scan.hpp"

#include <fcntl.h>
#include <libudev.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "hal/bus/hid_report_descriptor.hpp"
#include "hal/bus/usb_descriptor.hpp"
#include "hal/linux/hid_address.hpp"
#include "hal/linux/hiddev.hpp"
#include "hal/linux/printable_text.hpp"
#include "hal/linux/sysfs_places.hpp"

// Names of files and properties: the kernel's Documentation/ABI/{stable,testing}/sysfs-bus-usb and
// sysfs-driver-hid, and hid_uevent() in its hid-core.c.
namespace thimble::linux {
namespace {

constexpr std::size_t kMaxFileBytes = 65536;
constexpr std::size_t kMaxTextBytes = 256;  // a USB string has at most 126 letters

using Device = UdevHandle<udev_device>;

std::string text_of(const char* text) {
  return std::string(udev_text(text).substr(0, kMaxTextBytes));
}

// What the device says of itself is among these; of paths and names the kernel makes sure.
std::string attribute(udev_device* device, const char* name) {
  return printable_text(text_of(::udev_device_get_sysattr_value(device, name)));
}

std::string property(udev_device* device, const char* name) {
  return printable_text(text_of(::udev_device_get_property_value(device, name)));
}

template <class Number>
std::optional<Number> number_of(std::string_view text, int base) {
  Number number{0};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, base);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

// Not by libudev, to whom an attribute is text: a descriptor has zeros in it.
std::string bytes_of(udev_device* device, const char* name) {
  const std::string path = text_of(::udev_device_get_syspath(device)) + "/" + name;
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return {};
  std::string bytes(kMaxFileBytes, '\0');
  std::size_t size = 0;
  while (size < bytes.size()) {
    const ssize_t got = ::read(file, bytes.data() + size, bytes.size() - size);
    if (got <= 0) break;
    size += static_cast<std::size_t>(got);
  }
  ::close(file);
  bytes.resize(size);
  return bytes;
}

// HID_ID=0003:00001234:00000006, bus, vendor and product.
bool read_ids(const std::string& text, bus::BusDeviceInfo& info) {
  const std::size_t first = text.find(':');
  const std::size_t second = text.find(':', first == std::string::npos ? first : first + 1);
  if (second == std::string::npos) return false;
  const auto vendor =
      number_of<std::uint32_t>(std::string_view(text).substr(first + 1, second - first - 1), 16);
  const auto product = number_of<std::uint32_t>(std::string_view(text).substr(second + 1), 16);
  if (!vendor || !product || *vendor > 0xFFFF || *product > 0xFFFF) return false;
  info.vendor_id = static_cast<std::uint16_t>(*vendor);
  info.product_id = static_cast<std::uint16_t>(*product);
  return true;
}

void read_strings(udev_device* usb, bus::BusDeviceInfo& info) {
  info.manufacturer = attribute(usb, "manufacturer");
  info.product = attribute(usb, "product");
  info.serial_number = attribute(usb, "serial");
}

void read_lengths(udev_device* hid, bus::BusDeviceInfo& info) {
  const auto lengths = bus::parse_report_descriptor(bytes_of(hid, "report_descriptor"));
  if (!lengths) return;
  info.input_report_bytes = lengths->input_bytes;
  info.output_report_bytes = lengths->output_bytes;
  info.has_report_ids = lengths->has_report_ids;
}

// Of a node that hangs, somewhere, on a USB interface.
std::uint8_t interface_number(udev_device* node) {
  udev_device* interface =
      ::udev_device_get_parent_with_subsystem_devtype(node, "usb", "usb_interface");
  const std::string number = interface == nullptr ? "" : attribute(interface, "bInterfaceNumber");
  return number_of<std::uint8_t>(number, 16).value_or(0);
}

udev_device* usb_device_of(udev_device* node) {
  return ::udev_device_get_parent_with_subsystem_devtype(node, "usb", "usb_device");
}

std::optional<ReadDevice> read_hid(udev_device* hidraw) {
  udev_device* hid = ::udev_device_get_parent_with_subsystem_devtype(hidraw, "hid", nullptr);
  if (hid == nullptr) return std::nullopt;
  ReadDevice found;
  DevicePlace& place = found.place.emplace();
  found.device.node = text_of(::udev_device_get_devnode(hidraw));
  found.device.hiddev = hiddev_node_of(hid);
  bus::BusDeviceInfo& info = found.device.info;
  info.kind = bus::BusKind::Hid;
  if (found.device.node.empty() || !read_ids(property(hid, "HID_ID"), info)) return std::nullopt;
  udev_device* usb = usb_device_of(hid);
  if (usb != nullptr) {
    read_strings(usb, info);
    place.port = text_of(::udev_device_get_sysname(usb));
    place.interface_number = interface_number(hid);
  } else {
    info.product = property(hid, "HID_NAME");
    place.port = text_of(::udev_device_get_sysname(hid));
  }
  if (info.serial_number.empty()) info.serial_number = property(hid, "HID_UNIQ");
  place.serial_number = info.serial_number;
  read_lengths(hid, info);
  return found;
}

bool read_usb_ids(udev_device* usb, bus::BusDeviceInfo& info) {
  const auto vendor = number_of<std::uint16_t>(attribute(usb, "idVendor"), 16);
  const auto product = number_of<std::uint16_t>(attribute(usb, "idProduct"), 16);
  if (!vendor || !product) return false;
  info.vendor_id = *vendor;
  info.product_id = *product;
  return true;
}

std::optional<ReadDevice> read_serial(udev_device* tty) {
  udev_device* usb = usb_device_of(tty);
  if (usb == nullptr) return std::nullopt;
  ReadDevice found;
  found.device.node = text_of(::udev_device_get_devnode(tty));
  bus::BusDeviceInfo& info = found.device.info;
  info.kind = bus::BusKind::Serial;
  if (found.device.node.empty() || !read_usb_ids(usb, info)) return std::nullopt;
  read_strings(usb, info);
  found.place = {text_of(::udev_device_get_sysname(usb)), interface_number(tty),
                 info.serial_number};
  return found;
}

std::optional<ReadDevice> read_usb(udev_device* usb) {
  ReadDevice found;
  found.device.node = text_of(::udev_device_get_devnode(usb));
  bus::BusDeviceInfo& info = found.device.info;
  if (found.device.node.empty() || !read_usb_ids(usb, info)) return std::nullopt;
  info.kind = bus::BusKind::Usb;
  info.address = {"usb:" + text_of(::udev_device_get_sysname(usb))};
  read_strings(usb, info);
  const auto configuration =
      number_of<std::uint8_t>(attribute(usb, "bConfigurationValue"), 10).value_or(0);
  const std::string bytes = bytes_of(usb, "descriptors");
  const auto* first = reinterpret_cast<const std::uint8_t*>(bytes.data());
  auto endpoints = bus::parse_usb_descriptors({first, bytes.size()}, configuration);
  if (endpoints) info.endpoints = std::move(*endpoints);
  return found;
}

// In whatever thread, with a libudev of its own.
std::optional<ReadDevice> read_at(const SysfsPlace& place) {
  const UdevHandle<udev> context(::udev_new());
  if (context == nullptr) return std::nullopt;
  const Device device(::udev_device_new_from_syspath(context.get(), place.path.c_str()));
  if (device == nullptr) return std::nullopt;
  const std::string subsystem = text_of(::udev_device_get_subsystem(device.get()));
  const auto read = subsystem == "usb" ? &read_usb : subsystem == "tty" ? &read_serial : &read_hid;
  std::optional<ReadDevice> found = read(device.get());
  if (found) found->device.identity = place.identity;
  return found;
}

// Those of one kind, by their places among each other.
void address(std::vector<ReadDevice>& read, bus::BusKind kind,
             std::vector<bus::DeviceAddress> (*addresses_of)(std::span<const DevicePlace>)) {
  const auto is_meant = [&](const ReadDevice& one) {
    return one.place && one.device.info.kind == kind;
  };
  std::vector<DevicePlace> places;
  for (const ReadDevice& one : read) {
    if (is_meant(one)) places.push_back(*one.place);
  }
  const std::vector<bus::DeviceAddress> addresses = addresses_of(places);
  std::size_t next = 0;
  for (ReadDevice& one : read) {
    if (is_meant(one)) one.device.info.address = addresses[next++];
  }
}

std::vector<FoundDevice> with_addresses(std::vector<ReadDevice> read,
                                        const UdevScan::IsArm& is_arm) {
  for (ReadDevice& one : read) {
    if (one.place && is_arm) one.place->is_arm = is_arm(one.device.info);
  }
  address(read, bus::BusKind::Hid, &hid_addresses);
  address(read, bus::BusKind::Serial, &serial_addresses);
  std::vector<FoundDevice> found;
  found.reserve(read.size());
  for (ReadDevice& one : read) found.push_back(std::move(one.device));
  return found;
}

}  // namespace

UdevScan::UdevScan(IsArm is_arm) : is_arm_(std::move(is_arm)), context_(::udev_new()) {
  if (context_ == nullptr) return;
  // "udev": told when the rules have been applied, with the rights that they give.
  monitor_.reset(::udev_monitor_new_from_netlink(context_.get(), "udev"));
  if (monitor_ == nullptr) return;
  ::udev_monitor_filter_add_match_subsystem_devtype(monitor_.get(), "hidraw", nullptr);
  ::udev_monitor_filter_add_match_subsystem_devtype(monitor_.get(), "tty", nullptr);
  ::udev_monitor_filter_add_match_subsystem_devtype(monitor_.get(), "usb", "usb_device");
  if (::udev_monitor_enable_receiving(monitor_.get()) < 0) monitor_.reset();
}

UdevScan::~UdevScan() = default;

std::vector<FoundDevice> UdevScan::devices() {
  // Not during the look: a driver of a plugin may take its time.
  return with_addresses(read_all(), is_arm_);
}

std::vector<ReadDevice> UdevScan::read_all() {
  const std::lock_guard guard(looking_);
  std::set<std::string> identities;
  std::vector<ReadDevice> found;
  Duration patience = kPatience;
  for (const SysfsPlace& place : sysfs_places()) {
    identities.insert(place.identity);
    const std::size_t late = readings_.late();
    auto one = readings_.get(
        place, [place] { return read_at(place); }, patience);
    if (one) found.push_back(*std::move(one));
    if (readings_.late() > late) patience = kFurtherPatience;
  }
  readings_.keep(identities);
  return found;
}

bool UdevScan::has_news() noexcept {
  const std::unique_lock lock(looking_, std::try_to_lock);
  if (!lock.owns_lock()) return false;
  bool is_news = readings_.has_caught_up();
  if (monitor_ == nullptr) return is_news;
  constexpr int kMostAtOnce = 256;  // ours: a flood of events is for several calls
  pollfd watched{::udev_monitor_get_fd(monitor_.get()), POLLIN, 0};
  for (int i = 0; i < kMostAtOnce; ++i) {
    if (::poll(&watched, 1, 0) <= 0) break;
    // One that was lost or does not concern us gives nothing, and to look is never wrong.
    const Device device(::udev_monitor_receive_device(monitor_.get()));
    is_news = true;
  }
  return is_news;
}

}  // namespace thimble::linux
