#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <string>

#include "hal/base/result.hpp"
#include "lab/findings/findings.hpp"
#include "lab/trial/parallel.hpp"

namespace thimble::lab_commands {

// What every experiment is asked with.
struct Asked {
  std::uint64_t seed{1};
  std::uint64_t contacts{0};  // only where an experiment counts them
  lab::Progress progress{};
};
using Experiment = std::function<Result<lab::Findings>(const Asked&)>;

struct ExperimentCommand {
  std::string name;
  std::string help;
  std::uint64_t contacts{0};  // default of --contacts; 0: there is no such option
  Experiment run;
};

// The command `of` under `lab`, with --seed and --out; `code` must outlive the app. It prints what
// was found, with --out writes it into a folder, and while it takes long shows on a terminal how
// far it is. The exit code is 0 only where all criteria are met.
void add_experiment(CLI::App& lab, const ExperimentCommand& of, int& code);

// --out of `command`, into `folder`, which stays empty where it is not given: an empty one is
// refused.
void add_out(CLI::App& command, std::string& folder);
// Before the work: whether files can go to `folder`, which is made; empty: nothing to do. What is
// in the way is said.
[[nodiscard]] bool prepare_folder(const std::string& folder);

// On the terminal of standard error; nothing elsewhere, as a file has no use for it.
[[nodiscard]] lab::Progress shown_progress();

// Prints and writes; the exit code. `folder`: empty, or where files go.
[[nodiscard]] int finish_experiment(const Result<lab::Findings>& findings,
                                    const std::string& folder);

}  // namespace thimble::lab_commands
