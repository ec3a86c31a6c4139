#pragma once

#include <vector>

#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/linux/descriptor.hpp"

struct msghdr;

namespace thimble::linux {

// Open files that go from one process to another over a Unix socket, of which packets are kept
// apart (SOCK_SEQPACKET).
// Thread: one for each socket. Not RT.

// All that came with a message: the kernel hands over as many as had room, and closes the rest.
[[nodiscard]] std::vector<Descriptor> take_descriptors(msghdr& message);

// One, with a packet of one byte. Errors: System.
[[nodiscard]] Result<void> send_descriptor(int socket, const Descriptor& file);
// Errors: Timeout; Disconnected, the other side closed without a word; Malformed, something else
// came, and is closed; System. `patience`: below 0 none, above a minute a minute: ours, who needs
// longer does not answer at all.
[[nodiscard]] Result<Descriptor> receive_descriptor(int socket, Duration patience);

}  // namespace thimble::linux
