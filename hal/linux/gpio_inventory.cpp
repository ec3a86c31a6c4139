#include "hal/linux/gpio_inventory.hpp"

#include <cerrno>

#include "hal/linux/gpiod_chip.hpp"
#include "hal/linux/printable_text.hpp"
#include "hal/linux/system_error.hpp"

namespace thimble::linux {
namespace {

// Of a chip on a cable, which says its label itself, or of another process, which named its use.
std::string text_of(const char* text) { return text == nullptr ? "" : printable_text(text); }

}  // namespace

Result<GpioChipInfo> read_gpio_chip(const std::string& node) {
  const GpiodChip chip(gpiod_chip_open(node.c_str()));
  if (chip == nullptr) return tl::unexpected(system_error(node, errno));
  GpioChipInfo info{node, text_of(gpiod_chip_label(chip.get())), {}};
  for (unsigned i = 0; i < gpiod_chip_num_lines(chip.get()); ++i) {
    gpiod_line* const line = gpiod_chip_get_line(chip.get(), i);
    if (line == nullptr) return tl::unexpected(system_error(node, errno));
    info.lines.push_back({text_of(gpiod_line_name(line)), gpiod_line_is_used(line),
                          text_of(gpiod_line_consumer(line))});
  }
  return info;
}

}  // namespace thimble::linux
