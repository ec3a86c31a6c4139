#pragma once

#include <cstdint>
#include <string>

#include "hal/base/result.hpp"
#include "hal/linux/descriptor.hpp"

namespace thimble::linux {

// How a node takes the bytes that its driver means.
enum class NodeWay : std::uint8_t {
  AsTheyAre,        // a terminal, a bulk pipe, hidraw where reports have a number: it comes first
  HidrawAfterZero,  // hidraw wants a 0 where the number of a report would be
  Hiddev,           // HiddevOutput
};

// An opened device, for another process: the very file that its bytes leave by here, but of hidraw
// another one, since hidapi keeps its own. As long as one of its duplicates is open, wherever, a
// file is not closed for the kernel: interfaces of a USB device that were claimed stay claimed, and
// a terminal that is one process's alone (TIOCEXCL) stays so: the arm cannot be had anew before all
// have let go of it.
//
// Thread: a value; whoever has it. Not RT: closing waits for the kernel. Ownership: the caller's.
struct SharedDevice {
  Descriptor node;
  NodeWay way{NodeWay::AsTheyAre};
};

// Opens the hidraw node of a HID device to write to it. Thread: any; waits for the kernel, as long
// as it lets some HID device's write last. Not RT. Errors: Permission, NotFound, System.
[[nodiscard]] Result<SharedDevice> open_hidraw_to_share(const std::string& hidraw,
                                                        bool has_report_ids);
// The very file that is open as `node`, which stays the caller's, under another number.
// Thread: any; waits for nothing. Not RT. Errors: System.
[[nodiscard]] Result<SharedDevice> share_node(int node, NodeWay way = NodeWay::AsTheyAre);
// The same for a whole one; thread and errors as above.
[[nodiscard]] Result<SharedDevice> share_again(const SharedDevice& device);

}  // namespace thimble::linux
