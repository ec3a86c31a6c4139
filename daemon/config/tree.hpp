#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "daemon/config/report.hpp"
#include "daemon/config/toml.hpp"

namespace thimble::config {

// The text as a tree, or nothing and a mistake in `report`.
[[nodiscard]] std::optional<toml::table> parse_tree(std::string_view text, const std::string& file,
                                                    Report& report);

// Writes one "KEY=VALUE" over the tree; keys that are not there are made. What it wrote says
// "--set KEY" as its place. A mistake leaves the tree as it was, but for empty tables.
void apply_override(toml::table& root, std::string_view override_text, Report& report);

// Where `region` is written; `otherwise` for what has no place of its own.
[[nodiscard]] Place place_of(const toml::source_region& region, const Place& otherwise);

}  // namespace thimble::config
