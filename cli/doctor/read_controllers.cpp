#include "cli/doctor/read_controllers.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "cli/doctor/proc_text.hpp"
#include "cli/doctor/rights.hpp"
#include "hal/bus/hid_report_descriptor.hpp"
#include "hal/linux/hid_address.hpp"
#include "hal/linux/printable_text.hpp"
#include "hal/linux/usb_path.hpp"

// Paths: Documentation/ABI/{stable,testing}/sysfs-bus-usb of the kernel; the numbers of descriptors
// are hexadecimal there (drivers/usb/core/sysfs.c and endpoint.c).
namespace thimble::doctor {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHidraw = "/sys/class/hidraw";
constexpr const char* kTty = "/sys/class/tty";
constexpr const char* kUsb = "/sys/bus/usb/devices";

// An arm or not: one takes its name beside all others.
struct Candidate {
  Controller controller;
  bus::BusDeviceInfo info;
  linux::DevicePlace place;
};

// What the device says of itself.
std::string words_in(const FileTree& tree, const fs::path& file) {
  return linux::printable_text(trimmed(tree.text(file)));
}

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
  info.manufacturer = words_in(tree, folder / "manufacturer");
  info.product = words_in(tree, folder / "product");
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

// `folder`: of a USB device, behind all links.
std::string usb_path(const FileTree& tree, const fs::path& folder) {
  const std::string path = folder.string();
  const std::string_view hub = linux::root_hub_above(path);
  if (hub.empty()) return {};
  return linux::usb_path_of(path, tree.text(fs::path(hub) / "version"));
}

// Where a node is plugged in, as the real buses see it (UdevScan): below the nearest USB device,
// whose number goes before that of its own; `name`: its own, and what is below none is called so.
linux::DevicePlace place_of(const FileTree& tree, fs::path folder, const std::string& name,
                            const std::string& own_number) {
  linux::DevicePlace place{name, 0, linux::printable_text(own_number)};
  bool has_interface = false;
  for (; folder.has_relative_path(); folder = folder.parent_path()) {
    const auto number = parse_hexadecimal(tree.text(folder / "bInterfaceNumber"));
    if (number && !has_interface) place.interface_number = *number;
    has_interface = has_interface || number;
    if (!raw_usb_node(tree, folder)) continue;
    place.port = folder.filename().string();
    place.path = usb_path(tree, folder);
    place.own_name = name;
    const std::string said = words_in(tree, folder / "serial");
    if (!said.empty()) place.serial_number = said;
    return place;
  }
  place.interface_number = 0;
  return place;
}

void describe(bus::BusKind kind, std::uint16_t vendor, std::uint16_t product,
              const std::string& serial_number, Candidate& candidate) {
  candidate.controller.vendor_id = candidate.info.vendor_id = vendor;
  candidate.controller.product_id = candidate.info.product_id = product;
  candidate.controller.serial_number = candidate.info.serial_number = serial_number;
  candidate.info.kind = kind;
}

// Those of one kind among each other, by the function that names them for the daemon.
void address(std::vector<Candidate>& candidates, bus::BusKind kind,
             std::vector<bus::DeviceAddress> (*addresses_of)(std::span<const linux::DevicePlace>)) {
  std::vector<linux::DevicePlace> places;
  for (const Candidate& candidate : candidates) {
    if (candidate.info.kind == kind) places.push_back(candidate.place);
  }
  const std::vector<bus::DeviceAddress> addresses = addresses_of(places);
  std::size_t next = 0;
  for (Candidate& candidate : candidates) {
    if (candidate.info.kind != kind) continue;
    candidate.controller.address = addresses[next++].text;
    candidate.controller.former_address =
        std::string(bus::to_string(kind)) + ":" + linux::port_name(candidate.place);
    candidate.info.address = {candidate.controller.address};
  }
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

std::optional<Candidate> read_hid(const FileTree& tree, const std::string& name) {
  const fs::path device = fs::path(kHidraw) / name / "device";
  const auto ids = parse_hid_ids(tree.text(device / "uevent"));
  if (!ids) return std::nullopt;
  const fs::path node = tree.resolved(fs::path(kHidraw) / name);
  Candidate found;
  found.controller.node = tree.node("/dev/" + name);
  read_usb_above(tree, node, *ids, found.controller, found.info);
  found.place = place_of(tree, node, tree.resolved(device).filename().string(), ids->serial_number);
  describe(bus::BusKind::Hid, ids->vendor, ids->product, found.place.serial_number, found);
  const auto reports = bus::parse_report_descriptor(tree.text(device / "report_descriptor"));
  if (reports) {
    found.info.input_report_bytes = reports->input_bytes;
    found.info.output_report_bytes = reports->output_bytes;
    found.info.has_report_ids = reports->has_report_ids;
  }
  return found;
}

// Of a terminal on USB; of the machine's own there is nothing above it.
std::optional<Candidate> read_serial(const FileTree& tree, const std::string& name) {
  const fs::path node = tree.resolved(fs::path(kTty) / name);
  fs::path folder = node;
  std::optional<Node> raw;
  while (folder.has_relative_path() && !(raw = raw_usb_node(tree, folder))) {
    folder = folder.parent_path();
  }
  const auto vendor = parse_hexadecimal(tree.text(folder / "idVendor"));
  const auto product = parse_hexadecimal(tree.text(folder / "idProduct"));
  if (!raw || !vendor || !product) return std::nullopt;
  Candidate found;
  found.controller.node = tree.node("/dev/" + name);
  found.controller.raw_nodes = {*raw};
  read_device(tree, folder, found.controller, found.info);
  found.place = place_of(tree, node, name, {});
  describe(bus::BusKind::Serial, *vendor, *product, found.place.serial_number, found);
  return found;
}

std::optional<Candidate> read_usb(const FileTree& tree, const std::string& name) {
  const fs::path folder = fs::path(kUsb) / name;
  const auto vendor = parse_hexadecimal(tree.text(folder / "idVendor"));
  const auto product = parse_hexadecimal(tree.text(folder / "idProduct"));
  const auto node = raw_usb_node(tree, folder);
  if (!vendor || !product || !node) return std::nullopt;
  Candidate found;
  found.controller.node = *node;
  read_device(tree, folder, found.controller, found.info);
  describe(bus::BusKind::Usb, *vendor, *product, words_in(tree, folder / "serial"), found);
  found.place = {found.controller.usb_port, 0, found.info.serial_number, false,
                 usb_path(tree, tree.resolved(folder))};
  found.info.endpoints = read_endpoints(tree, folder);
  return found;
}

void add_found(const FileTree& tree, const char* folder,
               std::optional<Candidate> (*read)(const FileTree&, const std::string&),
               std::vector<Candidate>& candidates) {
  for (const std::string& name : tree.names_in(folder)) {
    if (auto candidate = read(tree, name)) candidates.push_back(*std::move(candidate));
  }
}

}  // namespace

std::vector<Controller> read_controllers(const FileTree& tree,
                                         const plugin::DriverRegistry& drivers) {
  std::vector<Candidate> candidates;
  add_found(tree, kHidraw, &read_hid, candidates);
  add_found(tree, kTty, &read_serial, candidates);
  add_found(tree, kUsb, &read_usb, candidates);
  for (Candidate& candidate : candidates) candidate.place.is_arm = drivers.knows(candidate.info);
  address(candidates, bus::BusKind::Hid, &linux::hid_addresses);
  address(candidates, bus::BusKind::Serial, &linux::serial_addresses);
  address(candidates, bus::BusKind::Usb, &linux::usb_addresses);
  std::vector<Controller> found;
  for (Candidate& candidate : candidates) {
    if (!candidate.place.is_arm) continue;
    const std::string& port = candidate.controller.usb_port;
    const bool is_listed =
        candidate.info.kind == bus::BusKind::Usb &&
        std::any_of(found.begin(), found.end(),
                    [&](const Controller& controller) { return controller.usb_port == port; });
    if (!is_listed) found.push_back(std::move(candidate.controller));
  }
  return found;
}

}  // namespace thimble::doctor
