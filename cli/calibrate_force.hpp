#pragma once

#include <cstddef>
#include <istream>
#include <optional>
#include <string>

#include "daemon/api/status.hpp"
#include "hal/base/result.hpp"

namespace thimble::cli {

struct CalibrateOptions {
  std::optional<double> most_newton;  // the strongest force asked for; nothing: 400 counts
  std::size_t steps{6};               // forces from 0 up to it
};

// The strongest force to ask `arm` for. Pure; total. Errors, for a person: the arm is lost, makes
// no force, is told amperes, or its limiter lets less through than that.
[[nodiscard]] Result<double> strongest_force_newton(const api::ArmStatus& arm,
                                                    const CalibrateOptions& options);

// Whether no more comes of `options` than the direction in which `arm` presses: it is asked for
// less than 400 counts. The value of a count must not come of so little: one too low makes every
// force stronger. Pure; total.
[[nodiscard]] bool is_trial(const api::ArmStatus& arm, const CalibrateOptions& options);

// Guides a person through measuring, with a kitchen scale, what one count of an arm's commands is
// in newtons: activates the arm, has it press down more and more, reads what the scale says from
// `typed`, and prints the line for the configuration to standard output, all else to standard
// error; after a trial no line, but what to do next. The arm is active for as long as this runs,
// and no longer. Returns the exit code.
int run_calibrate_force(const std::string& socket_path, const std::string& arm,
                        const CalibrateOptions& options, std::istream& typed);

}  // namespace thimble::cli
