#include "sim/export/simdev/options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "hal/linux/printable_text.hpp"

namespace thimble::sim {
namespace {

constexpr std::string_view kScheme = "sim:";
// Ours: an arm that is asked in each of them still answers before a servo takes it for silent.
constexpr unsigned kMostFramesAtOnce = 8;
constexpr unsigned kMostSlicesPerFrame = 10;  // the mechanics' own steps
constexpr double kMostAmpere = 32.767;        // what a board's report can say
constexpr unsigned kMostPort = 65535;
constexpr std::size_t kMostSerialBytes = 63;  // what uhid has room for

// What each kernel, and each terminal that shows it, takes as it is.
std::string judge_serial_number(const std::string& text) {
  const bool is_plain =
      std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c < '\x7f'; });
  if (is_plain && !text.empty() && text.size() <= kMostSerialBytes) return {};
  return "expected 1 to 63 printable letters of ASCII without blanks";
}

// With what was given in it.
std::string failure_message(const CLI::App* of, const CLI::Error& error) {
  return linux::printable_lines(CLI::FailureMessage::simple(of, error));
}

std::string refuse_empty(const std::string& text) {
  return text.empty() ? "expected a name, found \"\"" : "";
}

}  // namespace

tl::expected<SimdevOptions, int> parse_simdev_options(int argc, const char* const* argv) {
  SimdevOptions options;
  CLI::App cli{
      "thimble-simdev offers a simulated device to this machine's kernel, as if it were plugged "
      "in.\n"
      "SIGTERM or Ctrl-C unplugs it."};
  cli.add_option("model", options.model,
                 "the device, such as phantom-vintage; sim: in front may stand")
      ->required()
      ->type_name("MODEL");
  cli.add_flag("--uhid", options.is_uhid, "through /dev/uhid, as a HID device (needs root)");
  cli.add_flag("--vhci", options.is_vhci,
               "as a USB device of this machine (needs root, and the module vhci-hcd)");
  cli.add_option(
         "--usbip", options.usbip_port,
         "as a USB/IP server on this port of the loopback: usbip attach -r 127.0.0.1 -b 1-1")
      ->type_name("PORT")
      ->check(CLI::Range(0U, kMostPort));
  cli.add_option("--socket", options.socket, "where verbs are taken: move, press, unplug, log …")
      ->check(refuse_empty)
      ->type_name("FILE");
  cli.add_option("--plugin", options.plugins,
                 "a shared object that brings the device, as daemon.plugins names one")
      ->type_name("FILE")
      ->allow_extra_args(false);  // the next word is the model
  cli.add_option("--serial", options.serial_number,
                 "its serial number, so that two can be told apart")
      ->type_name("TEXT")
      ->check(judge_serial_number);
  cli.add_option("--amplifier-max-a", options.amplifier_max_a,
                 "full scale of its motor amplifiers, A")
      ->type_name("A")
      ->check(CLI::Range(0.0, kMostAmpere));
  CLI::Option* at_once =
      cli.add_option(
             "--frames-at-once", options.frames_at_once,
             "frames of its bus that are run in one go, at the end of the last: fewer wake-ups "
             "of this machine, and answers up to so many frames late")
          ->type_name("NUMBER")
          ->check(CLI::Range(1U, kMostFramesAtOnce));
  cli.add_option("--slices-per-frame", options.slices_per_frame,
                 "what moves in it is computed in so many parts of a frame, each at its own time, "
                 "in place of all at the end: it takes the processor for shorter at a time")
      ->type_name("NUMBER")
      ->check(CLI::Range(1U, kMostSlicesPerFrame))
      ->excludes(at_once);
  cli.add_option("--seed", options.seed, "of what is left to chance in it")->type_name("NUMBER");
  cli.set_version_flag("--version", std::string("thimble-simdev " THIMBLE_VERSION));
  cli.failure_message(&failure_message);
  try {
    cli.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int code = cli.exit(error);
    return tl::unexpected(code == 0 ? 0 : kExitUsage);
  }
  if (options.model.starts_with(kScheme)) options.model.erase(0, kScheme.size());
  return options;
}

}  // namespace thimble::sim
