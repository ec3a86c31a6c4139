#pragma once

#include <string>
#include <vector>

#include "cli/doctor/facts.hpp"
#include "cli/doctor/file_tree.hpp"

namespace thimble::doctor {

// The GPIO chips of the machine, asked what they are: nothing else tells who has a line. No line
// changes. Thread: any. Not RT.
void read_gpio_chips(const FileTree& tree, Facts& facts);

}  // namespace thimble::doctor
