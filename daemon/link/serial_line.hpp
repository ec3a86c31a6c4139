#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "daemon/link/link_counters.hpp"
#include "hal/base/result.hpp"
#include "hal/base/time.hpp"

namespace thimble::link {

// An opened serial port: the number of its file, closed with its last owner.
using LineNode = std::shared_ptr<const int>;
// Opens it, now or again; must not wait for what a line may never have. Errors: one sentence.
using OpenLine = std::function<Result<LineNode>()>;

// A serial line as both of its ends are told of it. Thread: the one that runs the
// io_context, which also calls `open`. RT: not.
struct SerialLine {
  std::string name{};  // "serial:/dev/ttyS0@115200": as a person says it
  std::uint32_t bit_per_s{115'200};
  OpenLine open{};
};

// Ours. How long what is due may wait while the port is not there, so that it is not asked for in
// vain.
inline constexpr Duration kLineAbsentWait = std::chrono::milliseconds(10);

// The name of the line, and what is wrong with it as far as one can tell. Pure; thread: any.
void tell_of_line(const SerialLine& line, const std::string& trouble, LinkStatus& out);

}  // namespace thimble::link
