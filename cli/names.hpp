#pragma once

#include <string>

namespace thimble::cli {

// For CLI11's check(): why `text` names no arm and no world (config::is_name()), or nothing when it
// does. A name goes into the target of a request, and an empty one, as of a variable that is not
// set, is no wish for the only arm. Pure.
[[nodiscard]] std::string refuse_no_name(const std::string& text);

}  // namespace thimble::cli
