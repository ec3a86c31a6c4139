#pragma once

#include <string>
#include <vector>

#include "hal/base/result.hpp"
#include "lab/findings/findings.hpp"

// What an experiment found, as files that others can go on with.
namespace thimble::lab_commands {

// Comma-separated (RFC 4180, lines end in '\n'): a line of names with units, then the rows, numbers
// with all their digits, nothing where there is no number. Pure.
[[nodiscard]] std::string to_csv(const lab::Table& table);
// Everything but the plots; what is not finite is null. Pure.
[[nodiscard]] std::string to_json(const lab::Findings& findings);
// A script of gnuplot's with its data that draws `stem`.svg and `stem`.png beside it. Pure.
[[nodiscard]] std::string to_gnuplot(const lab::Plot& plot, const std::string& stem);

// What was written, and what could not be drawn.
struct Written {
  std::vector<std::string> files;
  std::string not_drawn;  // why, of each plot; or empty
};
// Makes `folder`, so that a place where nothing can be written is told before the work of minutes.
// Errors: InvalidArgument where it is something else; System, with its name.
[[nodiscard]] Result<void> make_folder(const std::string& folder);
// Into `folder`, which is made: EXPERIMENT.json, EXPERIMENT-TABLE.csv, EXPERIMENT-PLOT.gp, and by
// gnuplot, where there is one, EXPERIMENT-PLOT.svg and .png. Errors: System, with the file's name.
[[nodiscard]] Result<Written> write_findings(const lab::Findings& findings,
                                             const std::string& folder);

}  // namespace thimble::lab_commands
