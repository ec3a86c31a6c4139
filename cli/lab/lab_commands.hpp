#pragma once

#include <CLI/CLI.hpp>

#include "hal/base/result.hpp"
#include "lab/cam_latency.hpp"

// `thimble lab`: the experiments of lab/ for people.
namespace thimble::lab_commands {

// What it found, to standard output, why it could not be found to standard error; the exit code:
// 0 only where each of the thesis's latencies is as it must be.
int print_cam_latency(const Result<lab::CamLatencyReport>& report);

// The commands, told of by `app`; `code` must outlive it.
void add_lab_commands(CLI::App& app, int& code);

}  // namespace thimble::lab_commands
