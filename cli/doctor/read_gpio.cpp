#include "cli/doctor/read_gpio.hpp"

#include <utility>

// Paths: the bus "gpio" of drivers/gpio/gpiolib.c of the kernel.
namespace thimble::doctor {

void read_gpio_chips(const FileTree& tree, Facts& facts) {
  for (const std::string& name : tree.names_in("/dev")) {
    if (!name.starts_with("gpiochip")) continue;
    const std::string path = "/dev/" + name;
    if (!tree.link(path).empty()) continue;  // another name of a chip
    Result<linux::GpioChipInfo> read = linux::read_gpio_chip(tree.place_of(path));
    if (!read) {
      if (read.error().code == Errc::Permission) facts.unread_gpio_chips.push_back(path);
      continue;
    }
    GpioChip chip{std::move(read->label), std::move(read->lines), tree.node(path), {}, {}, false};
    chip.device = tree.resolved("/sys/bus/gpio/devices/" + name).parent_path().filename().string();
    facts.gpio_chips.push_back(std::move(chip));
  }
}

}  // namespace thimble::doctor
