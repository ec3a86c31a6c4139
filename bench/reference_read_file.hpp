#pragma once

#include <cstddef>
#include <string>

// Reads a file from front to back, 64 KiB at a time, and returns how many bytes it had.
[[nodiscard]] std::size_t reference_read_file(const std::string& path);
