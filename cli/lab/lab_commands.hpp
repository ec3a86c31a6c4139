#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>

#include "hal/base/result.hpp"
#include "lab/cam_latency.hpp"

// `thimble lab`: the experiments of lab/ for people.
namespace thimble::lab_commands {

// What it found, to standard output, why it could not be found to standard error; the exit code:
// 0 only where each of the thesis's latencies is as it must be.
int print_cam_latency(const Result<lab::CamLatencyReport>& report);

// The pieces of `thimble lab separate` as they are at first: a file that `world.pieces.layout`
// reads, .npy or .nrrd by the end of its name. Pure. Errors: InvalidArgument for another end.
[[nodiscard]] Result<std::string> layout_file(std::uint64_t seed, const std::string& name);

// Moves them apart; `write`: a file for them as they are at first, or empty. The exit code.
int run_separate(std::uint64_t seed, const std::string& write);

// The commands, told of by `app`; `code` must outlive it.
void add_lab_commands(CLI::App& app, int& code);

}  // namespace thimble::lab_commands
