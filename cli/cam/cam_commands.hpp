#pragma once

#include <CLI/CLI.hpp>

namespace thimble::cam {

// `thimble cam …`, told of by `app`; `code`, the exit code of the one that ran, must outlive it.
void add_cam_commands(CLI::App& app, int& code);

}  // namespace thimble::cam
