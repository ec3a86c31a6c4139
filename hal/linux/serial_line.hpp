#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "hal/base/result.hpp"
#include "hal/bus/serial_port.hpp"
#include "hal/linux/descriptor.hpp"

namespace thimble::linux {

// The node of a serial port, raw and never blocking, and this process's alone: flock against
// another daemon, TIOCEXCL against everybody who does not look for that. What the kernel had
// received before is discarded.
//
// Thread: any; opening does not wait for a carrier, but a USB adapter is told the rate. Not RT.
// Errors: NotFound, Permission, Busy (another process holds it), InvalidArgument (no such rate) or
// System.
[[nodiscard]] Result<Descriptor> open_serial_line(const std::string& node,
                                                  const bus::SerialLine& line);

// Before the node is closed: who shares it must not keep the next opener out, nor make the kernel
// wait with what it has. Thread: any. Not RT. Errors: none; what the kernel refuses stays as it is.
void let_go_of_serial_line(int node) noexcept;

// The same for who knows no Descriptor: the number of the open file, let go of and closed with its
// last owner. Thread and errors as open_serial_line(). Not RT.
[[nodiscard]] Result<std::shared_ptr<const int>> share_serial_line(const std::string& node,
                                                                   std::uint32_t bit_per_s);

}  // namespace thimble::linux
