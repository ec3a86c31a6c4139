#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace thimble::bench {

// A line of /proc/PROCESS/status in bytes, e.g. "VmRSS"; `process` is a number or "self".
// Nothing when there is no such process or line.
[[nodiscard]] std::optional<double> process_bytes(const std::string& process,
                                                  std::string_view line);

}  // namespace thimble::bench
