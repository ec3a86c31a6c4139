#pragma once

#include <string>
#include <vector>

#include "cli/devices/inventory.hpp"

namespace thimble::devices_list {

// `daemon` is a sentence about the daemon: whether it was asked who uses what.
// For a person: lines of at most 80 columns.
[[nodiscard]] std::string render(const std::vector<Entry>& entries, const std::string& daemon);
// {"daemon": SENTENCE, "devices": [{"address", "description", "usable", "obstacle", "needs",
// "users"}]}
[[nodiscard]] std::string to_json(const std::vector<Entry>& entries, const std::string& daemon);

}  // namespace thimble::devices_list
