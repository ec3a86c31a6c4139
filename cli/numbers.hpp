#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace thimble::cli {

// For CLI11's check(): why `text` is no number that may be taken, or nothing when it is one. CLI11
// itself takes an empty text for 0, "010" for 8 and "-1" for the largest number there is. Pure.

// A whole number in decimal digits, without a sign, from `least` to `most`.
[[nodiscard]] std::string refuse_whole_number(std::string_view text, std::uint64_t least,
                                              std::uint64_t most);
// Any that 64 bits have room for.
[[nodiscard]] std::string refuse_other_than_whole(const std::string& text);
// A seed: from 0 to 2^53, as the configuration's, for up to there it is the same number again when
// it is read from a file of findings, whose numbers are doubles.
[[nodiscard]] std::string refuse_other_than_seed(const std::string& text);
// A finite number: "1", "-0.5", "+.5" or "2e-3".
[[nodiscard]] std::string refuse_finite_number(std::string_view text);

}  // namespace thimble::cli
