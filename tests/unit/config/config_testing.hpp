#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "daemon/config/load.hpp"

namespace thimble::config {

inline constexpr std::string_view kHello = R"([[arm]]
name = "right"
device = "sim:phantom-vintage"
world = "box"

[[world]]
name = "box"
source = "box:3"
)";

inline ConfigResult parse_text(std::string_view text,
                               const std::vector<std::string>& overrides = {}) {
  return parse(text, "/etc/thimble/t.toml", overrides);
}

// Every mistake of `text` in one line each; empty when there is none.
inline std::vector<std::string> mistakes(std::string_view text,
                                         const std::vector<std::string>& overrides = {}) {
  std::vector<std::string> out;
  const ConfigResult result = parse_text(text, overrides);
  if (result) return out;
  for (const ConfigError& error : result.error()) out.push_back(to_string(error));
  return out;
}

// kHello with lines put into its first [[arm]] table or its [[world]] table.
inline std::string hello_with_arm(std::string_view lines) {
  std::string text(kHello);
  return text.insert(text.find("\n[[world]]"), lines);
}
inline std::string hello_with_world(std::string_view lines) {
  return std::string(kHello).append(lines);
}

}  // namespace thimble::config
