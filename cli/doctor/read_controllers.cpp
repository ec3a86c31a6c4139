#include "cli/doctor/read_controllers.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>

#include "cli/doctor/proc_text.hpp"
#include "cli/doctor/rights.hpp"
#include "hal/bus/hid_report_descriptor.hpp"

// Paths: Documentation/ABI/{stable,testing}/sysfs-bus-usb of the kernel; the numbers of descriptors
// are hexadecimal there (drivers/usb/core/sysfs.c and endpoint.c).
namespace thimble::doctor {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHidraw = "/sys/class/hidraw";
constexpr const char* kTty = "/sys/class/tty";
constexpr const char* kUsb = "/sys/bus/usb/devices";

// Of the USB device in a folder; nothing when it is none.
std::optional<Node> raw_usb_node(const FileTree& tree, const fs::path& folder) {
  const auto bus = parse_integer(tree.text(folder / "busnum"));
  const auto device = parse_integer(tree.text(folder / "devnum"));
  if (!bus || !device) return std::nullopt;
  std::array<char, 64> path{};
  std::snprintf(path.data(), path.size(), "/dev/bus/usb/%03lld/%03lld",
                static_cast<long long>(*bus), static_cast<long long>(*device));
  Node node = tree.node(path.data());
  node.commanding_rights = kWrite;
  return node;
}

// What is the same of a device on HID and of one on bare USB.
void read_device(const FileTree& tree, const fs::path& folder, Controller& controller,
                 bus::BusDeviceInfo& info) {
  controller.usb_port = folder.filename().string();
  controller.speed_mbit_per_s = trimmed(tree.text(folder / "speed"));
  controller.power_control = trimmed(tree.text(folder / "power/control"));
  info.manufacturer = trimmed(tree.text(folder / "manufacturer"));
  info.product = trimmed(tree.text(folder / "product"));
}

// Whether the USB device is the HID device itself, whose ids usbhid_probe() of the kernel takes
// from it. A dongle of Bluetooth, or a receiver for several devices, has others.
bool is_the_same(const FileTree& tree, const fs::path& usb_device, const HidIds& ids) {
  return parse_hexadecimal(tree.text(usb_device / "idVendor")) == ids.vendor &&
         parse_hexadecimal(tree.text(usb_device / "idProduct")) == ids.product;
}

// Goes up from the HID device over its interface to the USB device.
void read_usb_above(const FileTree& tree, fs::path folder, const HidIds& ids,
                    Controller& controller, bus::BusDeviceInfo& info) {
  constexpr std::uint16_t kBusUsb = 3;  // BUS_USB of linux/input.h
  if (ids.bus != kBusUsb) return;
  std::vector<Node> nodes;
  for (; folder.has_relative_path(); folder = folder.parent_path()) {
    for (const std::string& name : tree.names_in(folder / "usbmisc")) {
      nodes.push_back(tree.node("/dev/usb/" + name));
    }
    auto raw = raw_usb_node(tree, folder);
    if (!raw) continue;
    if (!is_the_same(tree, folder, ids)) return;
    nodes.push_back(*std::move(raw));
    controller.raw_nodes = std::move(nodes);
    read_device(tree, folder, controller, info);
    return;
  }
}

std::string_view scheme_of(bus::BusKind kind) {
  if (kind == bus::BusKind::Hid) return "hid:";
  return kind == bus::BusKind::Serial ? "serial:" : "usb:";
}

// Ids and place, as the real buses give them.
void describe(bus::BusKind kind, const HidIds& ids, Controller& controller,
              bus::BusDeviceInfo& info) {
  controller.vendor_id = info.vendor_id = ids.vendor;
  controller.product_id = info.product_id = ids.product;
  controller.serial_number = info.serial_number = ids.serial_number;
  info.kind = kind;
  // On bare USB by the port alone, whatever number the device says.
  const bool is_by_number = kind != bus::BusKind::Usb && !ids.serial_number.empty();
  const std::string& place = is_by_number ? ids.serial_number : controller.usb_port;
  controller.address = std::string(scheme_of(kind)) + place;
  info.address = {controller.address};
}

std::optional<bus::UsbEndpointInfo> read_endpoint(const FileTree& tree, const fs::path& folder,
                                                  std::uint8_t interface_number) {
  const auto address = parse_hexadecimal(tree.text(folder / "bEndpointAddress"));
  const auto attributes = parse_hexadecimal(tree.text(folder / "bmAttributes"));
  const auto bytes = parse_hexadecimal(tree.text(folder / "wMaxPacketSize"));
  const auto interval = parse_hexadecimal(tree.text(folder / "bInterval"));
  if (!address || !attributes || !bytes || !interval) return std::nullopt;
  return bus::UsbEndpointInfo{interface_number, static_cast<std::uint8_t>(*address),
                              static_cast<bus::UsbTransferKind>(*attributes & 3U), *bytes,
                              static_cast<std::uint8_t>(*interval)};
}

// Of all interfaces, "1-4:1.0", and their endpoints, "ep_81".
std::vector<bus::UsbEndpointInfo> read_endpoints(const FileTree& tree, const fs::path& device) {
  std::vector<bus::UsbEndpointInfo> endpoints;
  for (const std::string& interface : tree.names_in(device)) {
    const auto number = parse_hexadecimal(tree.text(device / interface / "bInterfaceNumber"));
    if (!number) continue;
    for (const std::string& name : tree.names_in(device / interface)) {
      if (!name.starts_with("ep_")) continue;
      const auto endpoint =
          read_endpoint(tree, device / interface / name, static_cast<std::uint8_t>(*number));
      if (endpoint) endpoints.push_back(*endpoint);
    }
  }
  return endpoints;
}

std::optional<Controller> read_hid(const FileTree& tree, const plugin::DriverRegistry& drivers,
                                   const std::string& name) {
  const fs::path device = fs::path(kHidraw) / name / "device";
  const auto ids = parse_hid_ids(tree.text(device / "uevent"));
  const auto reports = bus::parse_report_descriptor(tree.text(device / "report_descriptor"));
  if (!ids || !reports) return std::nullopt;
  Controller controller;
  controller.node = tree.node("/dev/" + name);
  bus::BusDeviceInfo info;
  read_usb_above(tree, tree.resolved(fs::path(kHidraw) / name), *ids, controller, info);
  describe(bus::BusKind::Hid, *ids, controller, info);
  info.input_report_bytes = reports->input_bytes;
  info.output_report_bytes = reports->output_bytes;
  info.has_report_ids = reports->has_report_ids;
  if (!drivers.knows(info)) return std::nullopt;
  return controller;
}

// Of a terminal on USB; of the machine's own there is nothing above it.
std::optional<Controller> read_serial(const FileTree& tree, const plugin::DriverRegistry& drivers,
                                      const std::string& name) {
  fs::path folder = tree.resolved(fs::path(kTty) / name);
  std::optional<Node> raw;
  while (folder.has_relative_path() && !(raw = raw_usb_node(tree, folder))) {
    folder = folder.parent_path();
  }
  const auto vendor = parse_hexadecimal(tree.text(folder / "idVendor"));
  const auto product = parse_hexadecimal(tree.text(folder / "idProduct"));
  if (!raw || !vendor || !product) return std::nullopt;
  Controller controller;
  controller.node = tree.node("/dev/" + name);
  controller.raw_nodes = {*raw};
  bus::BusDeviceInfo info;
  read_device(tree, folder, controller, info);
  describe(bus::BusKind::Serial, {*vendor, *product, trimmed(tree.text(folder / "serial")), 0},
           controller, info);
  if (!drivers.knows(info)) return std::nullopt;
  return controller;
}

std::optional<Controller> read_usb(const FileTree& tree, const plugin::DriverRegistry& drivers,
                                   const std::string& name) {
  const fs::path folder = fs::path(kUsb) / name;
  const auto vendor = parse_hexadecimal(tree.text(folder / "idVendor"));
  const auto product = parse_hexadecimal(tree.text(folder / "idProduct"));
  const auto node = raw_usb_node(tree, folder);
  if (!vendor || !product || !node) return std::nullopt;
  Controller controller;
  controller.node = *node;
  bus::BusDeviceInfo info;
  read_device(tree, folder, controller, info);
  describe(bus::BusKind::Usb, {*vendor, *product, trimmed(tree.text(folder / "serial")), 0},
           controller, info);
  info.endpoints = read_endpoints(tree, folder);
  if (!drivers.knows(info)) return std::nullopt;
  return controller;
}

}  // namespace

std::vector<Controller> read_controllers(const FileTree& tree,
                                         const plugin::DriverRegistry& drivers) {
  std::vector<Controller> found;
  for (const std::string& name : tree.names_in(kHidraw)) {
    if (auto controller = read_hid(tree, drivers, name)) found.push_back(*std::move(controller));
  }
  for (const std::string& name : tree.names_in(kTty)) {
    if (auto controller = read_serial(tree, drivers, name)) found.push_back(*std::move(controller));
  }
  for (const std::string& name : tree.names_in(kUsb)) {
    const bool is_known =
        std::any_of(found.begin(), found.end(),
                    [&](const Controller& controller) { return controller.usb_port == name; });
    if (is_known) continue;
    if (auto controller = read_usb(tree, drivers, name)) found.push_back(*std::move(controller));
  }
  return found;
}

}  // namespace thimble::doctor
