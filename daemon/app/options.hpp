#pragma once

#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

namespace thimble::app {

struct Options {
  std::string config;
  std::vector<std::string> overrides;  // "KEY=VALUE"
  bool is_check{false};                // say whether the configuration is good, then end
  std::optional<double> for_s;         // end by itself after so long
  std::optional<std::string> summary;  // file for the final status, JSON
};

// Command line of thimbled. The unexpected value is the exit code after help, version or a
// mistake, which have been printed already.
[[nodiscard]] tl::expected<Options, int> parse_options(int argc, const char* const* argv);

}  // namespace thimble::app
