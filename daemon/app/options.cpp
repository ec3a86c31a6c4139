#include "daemon/app/options.hpp"

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdlib>

#include "daemon/app/exit_code.hpp"
#include "hal/linux/printable_text.hpp"

namespace thimble::app {
namespace {

constexpr double kLongestRun_s = 1e7;  // four months; a larger number is a slip of the pen

// CLI::Range lets NaN pass: it is neither below nor above.
std::string refuse_not_finite(const std::string& text) {
  if (std::isfinite(std::strtod(text.c_str(), nullptr))) return "";
  return "expected a finite number, found " + text;
}

std::string refuse_empty(const std::string& text) {
  return text.empty() ? "expected the name of a file, found nothing" : "";
}

}  // namespace

tl::expected<Options, int> parse_options(int argc, const char* const* argv) {
  Options options;
  CLI::App cli{
      "thimbled drives force-feedback arms and lets people touch simulated worlds.\n"
      "SIGTERM or Ctrl-C ends it: the force ramps to zero, the arm is switched off."};
  cli.add_option("--config", options.config, "the configuration, a TOML file")
      ->check(refuse_empty)
      ->required()
      ->type_name("FILE");
  cli.add_option("--set", options.overrides,
                 "overrides one key, e.g. servo.rate_hz=2000 or arm.right.limits.force_newton=2; "
                 "may be given several times")
      ->type_name("KEY=VALUE")
      ->type_size(1)
      ->allow_extra_args(false);
  cli.add_flag(
      "--check", options.is_check,
      "only say whether the configuration is good, and what it names can be had: exit 0, or 2 "
      "with every mistake");
  cli.add_option("--for", options.for_s, "end by itself after so many seconds, exit 0")
      ->type_name("SECONDS")
      ->check(refuse_not_finite)
      ->check(CLI::Range(0.0, kLongestRun_s));
  cli.add_option("--summary", options.summary, "write the final status there as JSON")
      ->check(refuse_empty)
      ->type_name("FILE");
  cli.set_version_flag("--version", std::string("thimbled " THIMBLE_VERSION));
  cli.failure_message(
      [](const CLI::App* of, const CLI::Error& error) {  // with what was given in it
        return linux::printable_lines(CLI::FailureMessage::simple(of, error));
      });
  try {
    cli.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int code = cli.exit(error);
    return tl::unexpected(code == 0 ? kExitOk : kExitUsage);
  }
  return options;
}

}  // namespace thimble::app
