#include "tests/support/mock_machine.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <umockdev.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <string_view>

namespace thimble::test {
namespace {

// Lists for umockdev: name, value, name, value, nullptr.
struct Pairs {
  explicit Pairs(std::initializer_list<std::string_view> said) : texts(said.begin(), said.end()) {
    for (std::string& text : texts) pointers.push_back(text.data());
    pointers.push_back(nullptr);
  }
  std::vector<std::string> texts;
  std::vector<char*> pointers;
};

std::string add(UMockdevTestbed* bed, const char* subsystem, const std::string& name,
                const std::string& parent, Pairs attributes, Pairs properties) {
  char* path = umockdev_testbed_add_devicev(bed, subsystem, name.c_str(),
                                            parent.empty() ? nullptr : parent.c_str(),
                                            attributes.pointers.data(), properties.pointers.data());
  std::string made = path;
  ::g_free(path);
  return made;
}

void set_bytes(UMockdevTestbed* bed, const std::string& path, const char* name,
               const MockMachine::Bytes& bytes) {
  MockMachine::Bytes copy = bytes;
  umockdev_testbed_set_attribute_binary(bed, path.c_str(), name, copy.data(),
                                        static_cast<gint>(copy.size()));
}

// umockdev answers for nodes that it was told of, or refuses; here the caller asks the kernel.
gboolean execute(UMockdevIoctlBase* /*base*/, UMockdevIoctlClient* client, gpointer /*data*/) {
  int error = 0;
  const int result = umockdev_ioctl_client_execute(client, &error, nullptr);
  umockdev_ioctl_client_complete(client, result, error);
  return TRUE;
}

void let_kernel_answer(UMockdevTestbed* bed, const std::string& node) {
  auto* const base = umockdev_ioctl_base_new();
  g_signal_connect(base, "handle-ioctl", G_CALLBACK(&execute), nullptr);
  if (umockdev_testbed_attach_ioctl(bed, node.c_str(), base, nullptr) == FALSE) std::abort();
  ::g_object_unref(base);
}

}  // namespace

MockMachine::MockMachine() : bed_(umockdev_testbed_new()) { find_bus(1, kController); }

MockMachine::~MockMachine() { ::g_object_unref(bed_); }

void MockMachine::find_bus(int number, const std::string& controller, const std::string& version) {
  const std::string path = "/sys/devices/" + controller;
  if (!std::filesystem::exists(root() + path)) {
    add(bed_, "pci", controller, "", Pairs({}), Pairs({}));
  }
  const std::string digits = std::to_string(number);
  hubs_[digits] =
      add(bed_, "usb", "usb" + digits, path,
          Pairs({"bDeviceClass", "09", "idVendor", "1d6b", "idProduct", "0002", "devnum", "1",
                 "version", version}),
          Pairs({"DEVTYPE", "usb_device", "DEVNAME", "/dev/bus/usb/00" + digits + "/001"}));
}

const std::string& MockMachine::hub_of(const std::string& port) const {
  return hubs_.at(port.substr(0, port.find('-')));
}

std::string MockMachine::plug(const UsbDevice& device) {
  const std::string number = std::to_string(device.number);
  const std::string node = "/dev/bus/usb/00" + device.port.substr(0, device.port.find('-')) + "/" +
                           std::string(3 - std::min<std::size_t>(3, number.size()), '0') + number;
  const std::string path =
      add(bed_, "usb", device.port, hub_of(device.port),
          Pairs({"bDeviceClass", device.device_class, "idVendor", device.vendor_id, "idProduct",
                 device.product_id, "devnum", number, "bConfigurationValue", "1", "manufacturer",
                 "Maker", "product", device.product, "serial", device.serial_number}),
          Pairs({"DEVTYPE", "usb_device", "DEVNAME", node}));
  set_bytes(bed_, path, "descriptors", device.descriptors);
  paths_.push_back(path);
  nodes_[path] = make_node(node);
  say(path, "add");
  return path;
}

std::string MockMachine::plug(const HidDevice& device) {
  return plug_below(plug_interface(device.port, device.interface_number), device);
}

std::string MockMachine::plug(const SerialDevice& device) {
  const std::string path =
      plug_node("tty", device.name, plug_interface(device.port, device.interface_number));
  if (device.terminal.empty()) return path;
  std::filesystem::remove(nodes_[path]);
  std::filesystem::create_symlink(device.terminal, nodes_[path]);
  let_kernel_answer(bed_, "/dev/" + device.name);
  return path;
}

std::string MockMachine::plug_hiddev(const std::string& port, int interface_number,
                                     const std::string& name) {
  const std::string interface =
      hub_of(port) + "/" + port + "/" + port + ":1." + std::to_string(interface_number);
  return plug_node("usbmisc", name, interface, "/dev/usb/");
}

std::string MockMachine::plug_console(const std::string& name) {
  return plug_node("tty", name, "");
}

std::string MockMachine::plug_interface(const std::string& port, int number) {
  const std::string digits = std::to_string(number);
  const std::string known = hub_of(port) + "/" + port + "/" + port + ":1." + digits;
  if (std::find(paths_.begin(), paths_.end(), known) != paths_.end()) return known;
  const std::string interface =
      add(bed_, "usb", port + ":1." + digits, hub_of(port) + "/" + port,
          Pairs({"bInterfaceNumber", "0" + digits}), Pairs({"DEVTYPE", "usb_interface"}));
  paths_.push_back(interface);
  return interface;
}

std::string MockMachine::plug_node(const char* subsystem, const std::string& name,
                                   const std::string& parent, const std::string& folder) {
  const std::string path =
      add(bed_, subsystem, name, parent, Pairs({}), Pairs({"DEVNAME", folder + name}));
  paths_.push_back(path);
  nodes_[path] = make_node(folder + name);
  say(path, "add");
  return path;
}

std::string MockMachine::plug_virtual(const HidDevice& device) {
  if (uhid_.empty()) uhid_ = add(bed_, "misc", "uhid", "", Pairs({}), Pairs({}));
  return plug_below(uhid_, device);
}

std::string MockMachine::plug_below(const std::string& parent, const HidDevice& device) {
  const std::string hid =
      add(bed_, "hid", "0003:1234:0006." + device.instance, parent, Pairs({}),
          Pairs({"HID_ID", device.ids, "HID_NAME", "Maker Arm", "HID_UNIQ", device.serial_number}));
  set_bytes(bed_, hid, "report_descriptor", device.report_descriptor);
  paths_.push_back(hid);
  return plug_node("hidraw", "hidraw" + std::to_string(device.node_number), hid);
}

// A plain file: what is below it, others stand in for.
std::string MockMachine::make_node(const std::string& name) {
  const std::filesystem::path file = root() + name;
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file).put('\n');
  std::filesystem::permissions(file, std::filesystem::perms(0600));
  return file;
}

void MockMachine::unplug(const std::string& path) {
  std::vector<std::string> gone;
  for (const std::string& known : paths_) {
    if (known == path || known.starts_with(path + "/")) gone.push_back(known);
  }
  std::sort(gone.begin(), gone.end(),
            [](const auto& a, const auto& b) { return a.size() > b.size(); });
  for (const std::string& known : gone) {
    if (nodes_.contains(known)) say(known, "remove");
    umockdev_testbed_remove_device(bed_, known.c_str());
    if (nodes_.contains(known)) std::filesystem::remove(nodes_[known]);
    std::erase(paths_, known);
  }
}

// A pipe: who reads it waits until its other end is closed. To open it must not wait, for umockdev
// lets one thread at a time open anything.
void MockMachine::hang(const std::string& path, const std::string& attribute) {
  const std::filesystem::path file = root() + path + "/" + attribute;
  std::filesystem::remove(file);
  if (::mkfifo(file.c_str(), 0600) != 0) std::abort();
  pipes_[file] = ::open(file.c_str(), O_RDWR | O_CLOEXEC);
}

void MockMachine::answer(const std::string& path, const std::string& attribute) {
  const std::filesystem::path file = root() + path + "/" + attribute;
  std::filesystem::remove(file);
  ::close(pipes_.at(file));
  pipes_.erase(file);
}

std::string MockMachine::root() const {
  char* path = umockdev_testbed_get_root_dir(bed_);
  std::string copy = path;
  ::g_free(path);
  return copy;
}

void MockMachine::let_others_look() {
  namespace fs = std::filesystem;
  fs::permissions(root(), fs::perms(0755));
  // umockdev's own, which it talks to before it opens a node.
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root())) {
    if (entry.is_socket()) fs::permissions(entry.path(), fs::perms(0777));
  }
}

void MockMachine::say(const std::string& path, const char* action) {
  umockdev_testbed_uevent(bed_, path.c_str(), action);
}

MockMachine::Bytes bulk_descriptors() {
  return {18,   1, 0, 2,  0xFF, 0, 0,  64, 3,    4,  0x48, 0xCB, 0, 1,  1, 2,    3,
          1,    9, 2, 32, 0,    1, 1,  0,  0x80, 50, 9,    4,    0, 0,  2, 0xFF, 0xFF,
          0xFF, 0, 7, 5,  0x81, 2, 64, 0,  0,    7,  5,    2,    2, 64, 0, 0};
}

MockMachine::Bytes plain_report_descriptor(std::uint8_t input_bytes, std::uint8_t output_bytes) {
  return {0x06, 0x00, 0xFF, 0x09,         0x01, 0xA1, 0x01,        0x15, 0x00,
          0x26, 0xFF, 0x00, 0x75,         0x08, 0x95, input_bytes, 0x09, 0x01,
          0x81, 0x02, 0x95, output_bytes, 0x09, 0x01, 0x91,        0x02, 0xC0};
}

MockMachine::Bytes numbered_reports(std::uint8_t input_bytes, std::uint8_t output_bytes) {
  MockMachine::Bytes descriptor = plain_report_descriptor(input_bytes, output_bytes);
  descriptor.insert(descriptor.begin() + 7, {0x85, 0x01});
  return descriptor;
}

}  // namespace thimble::test
