#pragma once

#include <cstdint>
#include <string>

#include "daemon/link/link_counters.hpp"
#include "hal/base/time.hpp"

namespace thimble::link {

// A serial line as both of its ends are told of it. A plain value. Thread: any; a copy is one
// thread's. RT: not: strings. Errors: none here; who reads it from outside has checked it.
struct SerialLine {
  std::string name{};  // "serial:/dev/ttyS0@115200": as a person says it
  std::string node{};  // "/dev/ttyS0": of this end
  std::uint32_t bit_per_s{115'200};
};

// Ours. How long what is due may wait while the port is not there, so that it is not asked for in
// vain.
inline constexpr Duration kLineAbsentWait = std::chrono::milliseconds(10);

// The name of the line, and what is wrong with it as far as one can tell. Pure; thread: any.
void tell_of_line(const SerialLine& line, const std::string& trouble, LinkStatus& out);

}  // namespace thimble::link
