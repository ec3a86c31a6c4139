#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "hal/base/result.hpp"
#include "hal/linux/descriptor.hpp"

namespace thimble::board {

// A memory BAR of a PCI device.
struct PciBar {
  std::string slot;  // as sysfs calls it: "0000:00:10.0"
  int number{0};     // 0 to 5
  bool operator==(const PciBar&) const = default;
};

// Total: InvalidArgument for what is no slot, or no BAR. Pure.
[[nodiscard]] Result<PciBar> parse_bar(std::string_view slot, std::string_view number);

// Makes the device answer to its memory, and opens the BAR for reading and writing once a CAM board
// stands behind it (docs/cambus.md, section 6). Nobody else is given it meanwhile: the file is
// locked until whoever got it has neither it nor its memory any more. `devices`:
// /sys/bus/pci/devices.
// Thread: any, not RT. Errors: NotMine where no board answers, which may come yet; Busy, it was
// given to somebody else; Permission, NotFound, System, InvalidArgument and TooLarge of the file.
[[nodiscard]] Result<linux::Descriptor> open_board(const std::filesystem::path& devices,
                                                   const PciBar& bar);

}  // namespace thimble::board
