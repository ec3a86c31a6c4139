#include "cli/doctor/udev_rules.hpp"

#include <array>
#include <cstdint>
#include <cstdio>

namespace thimble::doctor {
namespace {

std::string hexadecimal(std::uint16_t id, const char* format = "%04x") {
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), format, static_cast<unsigned>(id));
  return text.data();
}

bool is_usb(const Controller& controller) { return !controller.usb_port.empty(); }

// One parent has all of it: the USB device, to which all nodes of it belong, the raw one, too; or,
// of another bus, the HID device, whose name is BUS:VENDOR:PRODUCT.NUMBER in capital digits.
std::string match(const Controller& controller) {
  if (is_usb(controller)) {
    return "SUBSYSTEMS==\"usb\", ATTRS{idVendor}==\"" + hexadecimal(controller.vendor_id) +
           "\", ATTRS{idProduct}==\"" + hexadecimal(controller.product_id) + "\"";
  }
  return "SUBSYSTEM==\"hidraw\", KERNELS==\"*:" + hexadecimal(controller.vendor_id, "%04X") + ":" +
         hexadecimal(controller.product_id, "%04X") + ".*\"";
}

}  // namespace

std::vector<UdevRules> closing_rules(const Controller& controller) {
  const std::string ids =
      hexadecimal(controller.vendor_id) + "-" + hexadecimal(controller.product_id) + ".rules";
  // "0-" comes before "00-teensy.rules", and "73-seat-i" after those that give the tag "uaccess"
  // and before 73-seat-late.rules, which acts on it. One tag in place of all: what is taken away
  // with "-=" still matches there.
  return {{"0-thimble-" + ids,
           match(controller) + R"(, OWNER:="root", GROUP:="thimble", MODE:="0660")"},
          {"73-seat-ignores-thimble-" + ids, match(controller) + R"(, TAG="systemd")"}};
}

std::string closing_command(const Controller& controller) {
  std::string command;
  for (const UdevRules& rules : closing_rules(controller)) {
    command += "echo '" + rules.line + "' | sudo tee /etc/udev/rules.d/" + rules.file + " && ";
  }
  // The device and all that hangs on it.
  return command + "sudo udevadm control --reload && sudo udevadm trigger --settle " +
         (is_usb(controller) ? "--parent-match=/sys/bus/usb/devices/" + controller.usb_port
                             : controller.node.path);
}

std::string rules_that_speak_of(const Controller& controller) {
  return "grep -rils -e " + hexadecimal(controller.vendor_id) +
         " -e hidraw -e uaccess /etc/udev/rules.d /run/udev/rules.d /usr/local/lib/udev/rules.d "
         "/usr/lib/udev/rules.d";
}

}  // namespace thimble::doctor
