#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace thimble::cli {

// What stands where `app`, or the subcommand that was parsed last, wanted the name of a subcommand,
// and which name it probably was to be. Empty: nothing stands there, or a subcommand does.
// After a parse that failed. Thread: one. Errors: none.
[[nodiscard]] std::string tell_mistyped(const CLI::App& app);

}  // namespace thimble::cli
