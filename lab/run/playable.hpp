#pragma once

#include <string>
#include <vector>

#include "lab/run/played_file.hpp"

namespace thimble::lab {

// What cannot be had in virtual time of configurations that are played together, a sentence each
// that names the file, where there are several, and the key; empty: all of it can. Pure.
[[nodiscard]] std::vector<std::string> reasons_not_to_play(const std::vector<PlayedFile>& files);

// Of the servos, which one clock drives: what the first file says that says one, else 1000,
// whatever rate an arm would have of itself. Pure.
[[nodiscard]] double servo_rate_hz(const std::vector<PlayedFile>& files);

}  // namespace thimble::lab
