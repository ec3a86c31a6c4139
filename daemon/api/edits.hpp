#pragma once

#include <array>
#include <boost/json/fwd.hpp>
#include <cstdint>
#include <vector>

#include "daemon/api/request.hpp"

namespace thimble::api {

// Ours: so many edits, written without blanks, fit into the body that the server reads.
inline constexpr std::size_t kMaxEdits = 64;

// The edits in the document of a body: {"fill": {…}} or {"clear"…, "box"…, "paint"…}, or a list of
// such objects (docs/api.md). Pure and total: any document gives 1 to kMaxEdits edits or an error
// that names the first mistake.
[[nodiscard]] tl::expected<std::vector<CellEdit>, RequestError> parse_edits(
    const boost::json::value& document);

}  // namespace thimble::api
