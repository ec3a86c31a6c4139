#pragma once

#include <cstddef>
#include <vector>

// Round trips in seconds over loopback between two threads with a blocking UDP socket each: the
// bare system calls that a link cannot do without, in plain code without headers of the project.
// 12 bytes there and 13 back, as the datagrams of 1999. Empty when there is no socket.
[[nodiscard]] std::vector<double> reference_ping_pong(std::size_t round_trips);
