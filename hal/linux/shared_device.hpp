#pragma once

#include <cstddef>
#include <string>

#include "hal/base/result.hpp"
#include "hal/linux/descriptor.hpp"

namespace thimble::linux {

// An opened device, for another process: of USB and serial the very file that is open here, of HID
// another one. As long as one of its duplicates is open, wherever, a file is not closed for the
// kernel: interfaces of a USB device that were claimed stay claimed, and a terminal that is one
// process's alone (TIOCEXCL) stays so: the arm cannot be had anew before all have let go of it.
//
// Thread: a value; whoever has it. Not RT: closing waits for the kernel. Ownership: the caller's.
struct SharedDevice {
  Descriptor node;    // may be written
  Descriptor hiddev;  // of a HID device that takes plain bytes there, too (hiddev.hpp); else none
  // hidraw wants the number of a report before it, and 0 where reports have none; a report that has
  // one begins with it already.
  bool takes_leading_zero{false};
};

// Opens the nodes of a HID device that has such output reports; where only the second way cannot
// be had, `hiddev` is empty or it takes no plain bytes, that one is left out.
// Thread: any; waits for the kernel, as long as it lets some HID device's write last. Errors:
// Permission, NotFound, System.
[[nodiscard]] Result<SharedDevice> open_hid_to_share(const std::string& hidraw,
                                                     const std::string& hiddev, bool has_report_ids,
                                                     std::size_t output_report_bytes);
// The very file that is open as `node`, which stays the caller's, under another number.
// Thread: any; waits for nothing. Errors: System.
[[nodiscard]] Result<SharedDevice> share_node(int node);
// The same for a whole one.
[[nodiscard]] Result<SharedDevice> share_again(const SharedDevice& device);

}  // namespace thimble::linux
