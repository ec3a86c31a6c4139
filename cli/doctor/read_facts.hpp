#pragma once

#include <filesystem>

#include "cli/doctor/facts.hpp"

namespace thimble::doctor {

// Reads the machine whose /proc, /sys, /dev and /etc are below `root`; "/" is this one. Opens no
// device and changes nothing. What cannot be read stays empty.
// Thread: any. Not RT.
[[nodiscard]] Facts read_facts(const std::filesystem::path& root);

}  // namespace thimble::doctor
