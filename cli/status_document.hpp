#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "daemon/api/status.hpp"
#include "hal/base/result.hpp"

namespace thimble::cli {

// The status document (docs/api.md) as values. Total: what is missing or of another type is
// empty, a number that is not known is NaN (0 where it is counted); only bytes that are no JSON
// object, or one without the version that wrote it or without a list of arms, are an error
// (Malformed). Lists are cut at 1024 elements.
[[nodiscard]] Result<api::Status> parse_status(std::string_view json);

// The sentence of an error document, or `otherwise`.
[[nodiscard]] std::string parse_error_message(std::string_view json, std::string_view otherwise);
// The text member `key` of a document, or nothing when there is none.
[[nodiscard]] std::optional<std::string> parse_member(std::string_view json, std::string_view key);
// The count `key` of a document, or nothing when there is none.
[[nodiscard]] std::optional<std::uint64_t> parse_count(std::string_view json, std::string_view key);
// The yes or no `key` of a document, or nothing when there is none.
[[nodiscard]] std::optional<bool> parse_flag(std::string_view json, std::string_view key);

}  // namespace thimble::cli
