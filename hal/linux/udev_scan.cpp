#include "hal/linux/udev_scan.hpp"

#include <fcntl.h>
#include <libudev.h>
#include <poll.h>
#include <unistd.h>

#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "hal/linux/device_texts.hpp"
#include "hal/linux/hiddev.hpp"
#include "hal/linux/sysfs_places.hpp"
#include "hal/linux/usb_path.hpp"

// Names of files and properties: the kernel's Documentation/ABI/{stable,testing}/sysfs-bus-usb and
// sysfs-driver-hid, and hid_uevent() in its hid-core.c.
namespace thimble::linux {
namespace {

constexpr std::size_t kMaxFileBytes = 65536;

using Device = UdevHandle<udev_device>;

std::string attribute(udev_device* device, const char* name) {
  return std::string(udev_text(::udev_device_get_sysattr_value(device, name)));
}

std::string property(udev_device* device, const char* name) {
  return std::string(udev_text(::udev_device_get_property_value(device, name)));
}

// Not by libudev, to whom an attribute is text: a descriptor has zeros in it.
std::string bytes_of(udev_device* device, const char* name) {
  const std::string path = std::string(udev_text(::udev_device_get_syspath(device))) + "/" + name;
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

// Not ID_PATH of udev's database: it is not there yet for a device whose rules udevd is about to
// apply, and would call it otherwise then.
std::string path_of(udev_device* usb) {
  const std::string_view path = udev_text(::udev_device_get_syspath(usb));
  const std::string_view hub = root_hub_above(path);
  udev_device* above = usb;
  while (above != nullptr && udev_text(::udev_device_get_syspath(above)) != hub) {
    above = ::udev_device_get_parent(above);
  }
  return usb_path_of(path, above == nullptr ? "" : attribute(above, "version"));
}

void note_place(udev_device* usb, DeviceTexts& texts) {
  texts.port = udev_text(::udev_device_get_sysname(usb));
  texts.path = path_of(usb);
}

void note_strings(udev_device* usb, DeviceTexts& texts) {
  texts.vendor_id = attribute(usb, "idVendor");
  texts.product_id = attribute(usb, "idProduct");
  texts.manufacturer = attribute(usb, "manufacturer");
  texts.product = attribute(usb, "product");
  texts.serial_number = attribute(usb, "serial");
}

// Of a node that hangs, somewhere, on a USB interface.
std::string interface_number(udev_device* node) {
  udev_device* interface =
      ::udev_device_get_parent_with_subsystem_devtype(node, "usb", "usb_interface");
  return interface == nullptr ? "" : attribute(interface, "bInterfaceNumber");
}

udev_device* usb_above(udev_device* node) {
  return ::udev_device_get_parent_with_subsystem_devtype(node, "usb", "usb_device");
}

std::optional<ReadDevice> read_hid(udev_device* hidraw) {
  udev_device* hid = ::udev_device_get_parent_with_subsystem_devtype(hidraw, "hid", nullptr);
  if (hid == nullptr) return std::nullopt;
  udev_device* usb = usb_above(hid);
  DeviceTexts texts;
  texts.is_on_usb = usb != nullptr;
  texts.node = udev_text(::udev_device_get_devnode(hidraw));
  texts.hiddev = hiddev_node_of(hid);
  texts.name = udev_text(::udev_device_get_sysname(hid));
  texts.port = texts.name;
  texts.hid_id = property(hid, "HID_ID");
  texts.hid_name = property(hid, "HID_NAME");
  texts.hid_uniq = property(hid, "HID_UNIQ");
  texts.report_descriptor = bytes_of(hid, "report_descriptor");
  texts.interface_number = interface_number(hid);
  if (usb != nullptr) {
    note_place(usb, texts);
    note_strings(usb, texts);
  }
  return hid_device_of(texts);
}

std::optional<ReadDevice> read_serial(udev_device* tty) {
  udev_device* usb = usb_above(tty);
  if (usb == nullptr) return std::nullopt;
  DeviceTexts texts;
  texts.node = udev_text(::udev_device_get_devnode(tty));
  texts.name = udev_text(::udev_device_get_sysname(tty));
  note_place(usb, texts);
  texts.interface_number = interface_number(tty);
  note_strings(usb, texts);
  return serial_port_of(texts);
}

std::optional<ReadDevice> read_usb(udev_device* usb) {
  DeviceTexts texts;
  texts.node = udev_text(::udev_device_get_devnode(usb));
  note_place(usb, texts);
  texts.configuration = attribute(usb, "bConfigurationValue");
  texts.descriptors = bytes_of(usb, "descriptors");
  note_strings(usb, texts);
  return usb_device_of(texts);
}

// In whatever thread, with a libudev of its own.
std::optional<ReadDevice> read_at(const SysfsPlace& place) {
  const UdevHandle<udev> context(::udev_new());
  if (context == nullptr) return std::nullopt;
  const Device device(::udev_device_new_from_syspath(context.get(), place.path.c_str()));
  if (device == nullptr) return std::nullopt;
  const std::string_view subsystem = udev_text(::udev_device_get_subsystem(device.get()));
  const auto read = subsystem == "usb" ? &read_usb : subsystem == "tty" ? &read_serial : &read_hid;
  std::optional<ReadDevice> found = read(device.get());
  if (found) found->device.identity = place.identity;
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
