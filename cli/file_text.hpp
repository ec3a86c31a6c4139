#pragma once

#include <cstddef>
#include <string>

#include "hal/base/result.hpp"

namespace thimble::cli {

// For CLI11's check(): why an empty `text` names no file. Pure.
[[nodiscard]] std::string refuse_empty_name(const std::string& text);

// The first `bytes` of a file that a person named, or all of a shorter one.
// Errors: NotFound when it is not there, System when it cannot be opened or read; each with the
// system's word.
[[nodiscard]] Result<std::string> read_at_most(const std::string& file, std::size_t bytes);

// All of a file, made or replaced, as linux::replace_file() does it. Errors: System.
[[nodiscard]] Result<void> write_whole(const std::string& file, const std::string& content);

}  // namespace thimble::cli
