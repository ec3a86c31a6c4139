#include "hal/linux/gpio_inventory.hpp"

#include "hal/linux/gpiod_chip.hpp"
#include "hal/linux/printable_text.hpp"

namespace thimble::linux {

// The texts are those of a chip on a cable, which says its label itself, or of another process,
// which named its use.
Result<GpioChipInfo> read_gpio_chip(const std::string& node) {
  const Result<GpiodChip> chip = GpiodChip::open(node);
  if (!chip) return tl::unexpected(chip.error());
  GpioChipInfo info{node, printable_text(chip->label()), {}};
  for (std::size_t i = 0; i < chip->lines(); ++i) {
    Result<GpioLineInfo> line = chip->line_info(i);
    if (!line) return tl::unexpected(line.error());
    info.lines.push_back(
        {printable_text(line->name), line->is_taken, printable_text(line->consumer)});
  }
  return info;
}

}  // namespace thimble::linux
