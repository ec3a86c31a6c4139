#include "hal/linux/udev_scan.hpp"

#include <fcntl.h>
#include <libudev.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

#include "hal/bus/hid_report_descriptor.hpp"
#include "hal/bus/usb_descriptor.hpp"
#include "hal/linux/hid_address.hpp"

// Names of files and properties: the kernel's Documentation/ABI/{stable,testing}/sysfs-bus-usb and
// sysfs-driver-hid, and hid_uevent() in its hid-core.c.
namespace thimble::linux {
namespace {

constexpr std::size_t kMaxFileBytes = 65536;
constexpr std::size_t kMaxTextBytes = 256;  // a USB string has at most 126 letters
constexpr const char* kHubClass = "09";

struct FreeDevice {
  void operator()(udev_device* device) const noexcept { ::udev_device_unref(device); }
};
using Device = std::unique_ptr<udev_device, FreeDevice>;

struct FreeList {
  void operator()(udev_enumerate* list) const noexcept { ::udev_enumerate_unref(list); }
};

std::string text_of(const char* text) {
  return text == nullptr ? std::string()
                         : std::string(std::string_view(text).substr(0, kMaxTextBytes));
}

std::string attribute(udev_device* device, const char* name) {
  return text_of(::udev_device_get_sysattr_value(device, name));
}

std::string property(udev_device* device, const char* name) {
  return text_of(::udev_device_get_property_value(device, name));
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

struct FoundHid {
  FoundDevice device;
  HidPlace place;
};

std::optional<FoundHid> read_hid(udev_device* hidraw) {
  udev_device* hid = ::udev_device_get_parent_with_subsystem_devtype(hidraw, "hid", nullptr);
  if (hid == nullptr) return std::nullopt;
  FoundHid found;
  found.device.node = text_of(::udev_device_get_devnode(hidraw));
  found.device.identity = text_of(::udev_device_get_syspath(hidraw));
  bus::BusDeviceInfo& info = found.device.info;
  info.kind = bus::BusKind::Hid;
  if (found.device.node.empty() || !read_ids(property(hid, "HID_ID"), info)) return std::nullopt;
  udev_device* usb = ::udev_device_get_parent_with_subsystem_devtype(hid, "usb", "usb_device");
  if (usb != nullptr) {
    read_strings(usb, info);
    found.place.port = text_of(::udev_device_get_sysname(usb));
    udev_device* interface =
        ::udev_device_get_parent_with_subsystem_devtype(hid, "usb", "usb_interface");
    const std::string number = interface == nullptr ? "" : attribute(interface, "bInterfaceNumber");
    found.place.interface_number = number_of<std::uint8_t>(number, 16).value_or(0);
  } else {
    info.product = property(hid, "HID_NAME");
    found.place.port = text_of(::udev_device_get_sysname(hid));
  }
  if (info.serial_number.empty()) info.serial_number = property(hid, "HID_UNIQ");
  found.place.serial_number = info.serial_number;
  read_lengths(hid, info);
  return found;
}

std::optional<FoundDevice> read_usb(udev_device* usb) {
  const std::string type = text_of(::udev_device_get_devtype(usb));
  if (type != "usb_device" || attribute(usb, "bDeviceClass") == kHubClass) return std::nullopt;
  FoundDevice found;
  found.node = text_of(::udev_device_get_devnode(usb));
  found.identity = text_of(::udev_device_get_syspath(usb)) + " " + attribute(usb, "devnum");
  const auto vendor = number_of<std::uint16_t>(attribute(usb, "idVendor"), 16);
  const auto product = number_of<std::uint16_t>(attribute(usb, "idProduct"), 16);
  if (found.node.empty() || !vendor || !product) return std::nullopt;
  bus::BusDeviceInfo& info = found.info;
  info.kind = bus::BusKind::Usb;
  info.address = {"usb:" + text_of(::udev_device_get_sysname(usb))};
  info.vendor_id = *vendor;
  info.product_id = *product;
  read_strings(usb, info);
  const auto configuration =
      number_of<std::uint8_t>(attribute(usb, "bConfigurationValue"), 10).value_or(0);
  const std::string bytes = bytes_of(usb, "descriptors");
  const auto* first = reinterpret_cast<const std::uint8_t*>(bytes.data());
  auto endpoints = bus::parse_usb_descriptors({first, bytes.size()}, configuration);
  if (endpoints) info.endpoints = std::move(*endpoints);
  return found;
}

// What `subsystem` has, in the order of its paths.
std::vector<Device> devices_of(udev* context, const char* subsystem) {
  std::vector<Device> devices;
  const std::unique_ptr<udev_enumerate, FreeList> list(::udev_enumerate_new(context));
  if (list == nullptr) return devices;
  ::udev_enumerate_add_match_subsystem(list.get(), subsystem);
  ::udev_enumerate_scan_devices(list.get());
  for (udev_list_entry* entry = ::udev_enumerate_get_list_entry(list.get()); entry != nullptr;
       entry = ::udev_list_entry_get_next(entry)) {
    Device device(::udev_device_new_from_syspath(context, ::udev_list_entry_get_name(entry)));
    if (device != nullptr) devices.push_back(std::move(device));  // else gone meanwhile
  }
  return devices;
}

}  // namespace

void UdevScan::Free::operator()(udev* context) const noexcept { ::udev_unref(context); }
void UdevScan::Free::operator()(udev_monitor* monitor) const noexcept {
  ::udev_monitor_unref(monitor);
}

UdevScan::UdevScan() : context_(::udev_new()) {
  if (context_ == nullptr) return;
  // "udev": told when the rules have been applied, with the rights that they give.
  monitor_.reset(::udev_monitor_new_from_netlink(context_.get(), "udev"));
  if (monitor_ == nullptr) return;
  ::udev_monitor_filter_add_match_subsystem_devtype(monitor_.get(), "hidraw", nullptr);
  ::udev_monitor_filter_add_match_subsystem_devtype(monitor_.get(), "usb", "usb_device");
  if (::udev_monitor_enable_receiving(monitor_.get()) < 0) monitor_.reset();
}

UdevScan::~UdevScan() = default;

std::vector<FoundDevice> UdevScan::devices() const {
  std::vector<FoundDevice> found;
  if (context_ == nullptr) return found;
  std::vector<HidPlace> places;
  for (const Device& device : devices_of(context_.get(), "hidraw")) {
    std::optional<FoundHid> hid = read_hid(device.get());
    if (!hid) continue;
    found.push_back(std::move(hid->device));
    places.push_back(std::move(hid->place));
  }
  const std::vector<bus::DeviceAddress> addresses = hid_addresses(places);
  for (std::size_t i = 0; i < addresses.size(); ++i) found[i].info.address = addresses[i];
  for (const Device& device : devices_of(context_.get(), "usb")) {
    if (std::optional<FoundDevice> usb = read_usb(device.get())) found.push_back(std::move(*usb));
  }
  return found;
}

bool UdevScan::has_news() noexcept {
  if (monitor_ == nullptr) return false;
  constexpr int kMostAtOnce = 256;  // ours: a flood of events is for several calls
  bool is_news = false;
  pollfd watched{::udev_monitor_get_fd(monitor_.get()), POLLIN, 0};
  for (int i = 0; i<kMostAtOnce&& ::poll(&watched, 1, 0)> 0; ++i) {
    // One that was lost or does not concern us gives nothing, and to look is never wrong.
    const Device device(::udev_monitor_receive_device(monitor_.get()));
    is_news = true;
  }
  return is_news;
}

}  // namespace thimble::linux
