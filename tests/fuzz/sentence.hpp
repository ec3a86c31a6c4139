#pragma once

#include <algorithm>
#include <cstddef>

#include "hal/base/check.hpp"
#include "hal/base/result.hpp"

namespace thimble::fuzz {

// What a person is told of bytes is one short printable sentence, whatever the bytes were.
inline void require_sentence(const Error& error, std::size_t below_bytes) {
  THIMBLE_CHECK(!error.message.empty() && error.message.size() < below_bytes);
  THIMBLE_CHECK(std::all_of(error.message.begin(), error.message.end(),
                            [](char c) { return c >= ' ' && c <= '~'; }));
}

}  // namespace thimble::fuzz
