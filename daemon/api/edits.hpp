#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "daemon/api/request.hpp"

namespace thimble::api {

// Ours: so many edits, written without blanks, fit into the body that the server reads.
inline constexpr std::size_t kMaxEdits = 64;

// The edits in a body: {"fill": {…}} or {"clear"…, "box"…, "paint"…}, or a list of such objects
// (docs/api.md). Pure and total: any bytes give 1 to kMaxEdits edits or an error that names the
// first mistake.
[[nodiscard]] tl::expected<std::vector<CellEdit>, RequestError> parse_edits(std::string_view body);

}  // namespace thimble::api
