#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdint>
#include <exception>
#include <functional>
#include <iostream>
#include <limits>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include "cli/calibrate_force.hpp"
#include "cli/cam/cam_commands.hpp"
#include "cli/commands.hpp"
#include "cli/devices/devices.hpp"
#include "cli/doctor/doctor.hpp"
#include "cli/file_text.hpp"
#include "cli/flight/report.hpp"
#include "cli/flight/show.hpp"
#include "cli/lab/lab_commands.hpp"
#include "cli/mistyped.hpp"
#include "cli/names.hpp"
#include "cli/numbers.hpp"
#include "cli/picture/snapshot.hpp"
#include "daemon/api/commands.hpp"
#include "daemon/config/paths.hpp"
#include "hal/linux/printable_text.hpp"
#include "hal/linux/standard_streams.hpp"

namespace {

using thimble::cli::kExitOk;
using thimble::cli::kExitRefused;
using thimble::cli::kExitUsage;
using thimble::cli::run_command;
using thimble::cli::run_report;
using thimble::cli::run_status;
using thimble::cli::run_watch;
using thimble::cli::WatchOptions;
using thimble::devices_list::Form;
using thimble::devices_list::run_devices;
using thimble::doctor::run_doctor;

struct Arguments {
  std::string socket_path;
  std::string arm;
  std::optional<std::uint32_t> fault;
  double impedance_newton_s_per_m{0};
  std::string file;
  std::string root{"/"};
  double before_s{thimble::flight::kDefaultBefore_s};
  std::vector<std::string> plugins;
  std::string config;
  bool is_json{false};
  bool is_toml{false};
  WatchOptions watch;
  std::string world;
  thimble::cli::WorldEdit edit;
  thimble::cli::CalibrateOptions calibrate;
};

// As a check: what a person gave for a number is one (cli/numbers.hpp).
std::string refuse_not_finite(const std::string& text) {
  return thimble::cli::refuse_finite_number(text);
}

std::string refuse_no_cell(const std::string& text) {
  return thimble::cli::refuse_whole_number(text, 0, std::numeric_limits<std::int32_t>::max());
}

std::string refuse_no_fault(const std::string& text) {
  return thimble::cli::refuse_whole_number(text, 1, std::numeric_limits<std::uint32_t>::max());
}

std::string refuse_no_value(const std::string& text) {
  return thimble::cli::refuse_whole_number(text, 0, std::numeric_limits<std::uint8_t>::max());
}

std::string refuse_no_steps(const std::string& text) {
  return thimble::cli::refuse_whole_number(text, 3, 20);
}

void add_status_commands(CLI::App& app, Arguments& arguments, int& code) {
  CLI::App* status = app.add_subcommand("status", "Say how the daemon and its arms are");
  status->add_flag("--json", arguments.is_json, "As a JSON document (docs/api.md)");
  status->callback([&] { code = run_status(arguments.socket_path, arguments.is_json); });

  CLI::App* watch = app.add_subcommand("watch", "Show forces, offsets and contacts live");
  watch->add_option("--interval", arguments.watch.interval_s, "Seconds between pictures")
      ->check(refuse_not_finite)
      ->check(CLI::Range(0.02, 3600.0))
      ->capture_default_str();
  watch->add_option("--for", arguments.watch.for_s, "End after so many seconds")
      ->check(refuse_not_finite)
      ->check(CLI::Range(0.0, 1e6));
  watch->callback([&] { code = run_watch(arguments.socket_path, arguments.watch); });

  CLI::App* report = app.add_subcommand("report", "Tell of a session that thimbled summarised");
  report->add_option("FILE", arguments.file, "What thimbled --summary wrote")->required();
  report->callback([&] { code = run_report(arguments.file); });
}

CLI::App* add_machine_command(CLI::App& app, const char* name, const char* what,
                              Arguments& arguments, const std::function<void()>& run) {
  CLI::App* command = app.add_subcommand(name, what);
  command->add_flag("--json", arguments.is_json, "As a JSON document");
  command
      ->add_option("--root", arguments.root, "Look below this folder for /proc, /sys, /dev, /etc")
      ->check(CLI::ExistingDirectory)
      ->capture_default_str();
  command
      ->add_option(
          "--plugin", arguments.plugins,
          "Also what this shared object brings (daemon.plugins); may be given several times")
      ->type_name("FILE")
      ->type_size(1)
      ->allow_extra_args(false);
  command->callback(run);
  return command;
}

void add_machine_commands(CLI::App& app, Arguments& arguments, int& code) {
  add_machine_command(
      app, "doctor", "Say what on this machine is in the way of an arm, and what mends it",
      arguments,
      [&app, &arguments, &code] {
        const bool is_named = app.count("--socket") > 0;
        code = run_doctor({arguments.root, arguments.plugins, arguments.is_json, arguments.config,
                           is_named ? arguments.socket_path : ""});
      })
      ->add_option("--config", arguments.config,
                   "The daemon's configuration: look for what this one asks for")
      ->type_name("FILE")
      ->check(thimble::cli::refuse_empty_name);
  CLI::App* devices = add_machine_command(
      app, "devices", "List what arm.device could name, and why anything cannot be used", arguments,
      [&] {
        const Form form = arguments.is_toml   ? Form::Toml
                          : arguments.is_json ? Form::Json
                                              : Form::Text;
        code = run_devices({arguments.socket_path, arguments.root, arguments.plugins, form});
      });
  devices
      ->add_flag("--toml", arguments.is_toml,
                 "As the tables that a configuration lacks of arms that are plugged in")
      ->excludes("--json")
      ->excludes("--root");
}

void add_flight_commands(CLI::App& app, Arguments& arguments, int& code) {
  CLI::App* flight = app.add_subcommand("flight", "Look at flight recordings of latched stops");
  flight->require_subcommand(1);
  CLI::App* show = flight->add_subcommand("show", "Tell the cause, and what went before it");
  show->add_option("FILE", arguments.file, "What thimbled wrote to daemon.flight_directory")
      ->required()
      ->check(thimble::cli::refuse_empty_name);
  show->add_option("--before", arguments.before_s, "Seconds before the stop that the table shows")
      ->check(refuse_not_finite)
      ->check(CLI::Range(0.0, 60.0))
      ->capture_default_str();
  show->callback([&] { code = thimble::flight::run_show(arguments.file, arguments.before_s); });
}

CLI::App* add_arm_command(CLI::App& app, const char* verb, const char* what, Arguments& arguments,
                          int& code) {
  CLI::App* command = app.add_subcommand(verb, what);
  command->add_option("ARM", arguments.arm, "Name of the arm; not needed when there is one")
      ->check(thimble::cli::refuse_no_name);
  command->callback([&, verb] {
    const std::string body =
        arguments.fault ? "{\"fault\":" + std::to_string(*arguments.fault) + "}" : "";
    code = run_command(arguments.socket_path, verb, arguments.arm, body);
  });
  return command;
}

void add_impedance_command(CLI::App& app, Arguments& arguments, int& code) {
  CLI::App* command = app.add_subcommand(
      "impedance",
      "Tune an arm of the scheme \"wave\" while it runs: light and soft to heavy and hard");
  command
      ->add_option("NEWTON_S_PER_M", arguments.impedance_newton_s_per_m,
                   "Wave impedance, in N s/m: 2 is a pencil, 40 a heavy drill")
      ->required()
      ->check(refuse_not_finite)
      ->check(CLI::Range(thimble::api::kLeastImpedance_newton_s_per_m,
                         thimble::api::kMostImpedance_newton_s_per_m));
  command->add_option("ARM", arguments.arm, "Name of the arm; not needed when there is one")
      ->check(thimble::cli::refuse_no_name);
  command->callback([&] {
    code = run_command(
        arguments.socket_path, "impedance", arguments.arm,
        "{\"newton_s_per_m\":" + std::to_string(arguments.impedance_newton_s_per_m) + "}");
  });
}

void add_calibrate_command(CLI::App& app, Arguments& arguments, int& code) {
  CLI::App* command = app.add_subcommand(
      "calibrate-force", "Measure with a kitchen scale what a count of an arm is in newtons");
  command->add_option("ARM", arguments.arm, "Name of the arm; not needed when there is one")
      ->check(thimble::cli::refuse_no_name);
  command->add_option("--most", arguments.calibrate.most_newton, "The strongest force, in newtons")
      ->check(refuse_not_finite)
      ->check(CLI::Range(0.5, 8.0));
  command->add_option("--steps", arguments.calibrate.steps, "How many forces, 0 among them")
      ->check(refuse_no_steps)
      ->capture_default_str();
  command->callback([&] {
    code = thimble::cli::run_calibrate_force(arguments.socket_path, arguments.arm,
                                             arguments.calibrate, std::cin);
  });
}

void add_world_command(CLI::App& app, Arguments& arguments, int& code) {
  constexpr int kAxes = 3;
  thimble::cli::WorldEdit& edit = arguments.edit;
  CLI::App* command =
      app.add_subcommand("world", "Change the cells of a world, or save and load it");
  command
      ->add_option("EDIT", edit.verb,
                   "fill, clear, box (its six sides) or paint (a ball); save or load, of "
                   "a world that runs by itself; save, of pieces: their layout")
      ->required()
      ->check(CLI::IsMember({"fill", "clear", "box", "paint", "save", "load"}));
  command->add_option("WORLD", arguments.world, "Name of the world; not needed when there is one")
      ->check(thimble::cli::refuse_no_name);
  command->add_option("--min", edit.min, "First cell along x, y and z; default: of the whole world")
      ->check(refuse_no_cell)
      ->expected(kAxes);
  command->add_option("--max", edit.max, "Last cell along x, y and z, itself included")
      ->check(refuse_no_cell)
      ->expected(kAxes);
  command->add_option("--center", edit.center_m, "Of the ball to paint: x, y and z in metres")
      ->check(refuse_not_finite)
      ->expected(kAxes);
  command->add_option("--radius", edit.radius_m, "Of the ball to paint, in metres")
      ->check(refuse_not_finite);
  command
      ->add_option("--cell", edit.cell,
                   "What the cells become: 0 free, 1 filled, 1 + n of the n-th material")
      ->check(refuse_no_value);
  command->add_option("--file", edit.file, "To save to, or load")
      ->check(thimble::cli::refuse_empty_name);
  command->callback([&] {
    const std::string misfit = thimble::cli::find_misfit(edit);
    if (!misfit.empty()) throw CLI::ValidationError("world", misfit);
    const auto run = thimble::cli::is_about_state(edit) ? thimble::cli::run_world_state
                                                        : thimble::cli::run_world_edit;
    code = run(arguments.socket_path, arguments.world, edit);
  });
}

void add_piece_command(CLI::App& app, const char* verb, const char* what, Arguments& arguments,
                       int& code, bool may_name_arm = false) {
  CLI::App* command = app.add_subcommand(verb, what);
  command
      ->add_option("WORLD", arguments.world,
                   may_name_arm ? "Name of the world, or of an arm whose far world is meant"
                                : "Name of the world; not needed when there is one")
      ->check(thimble::cli::refuse_no_name);
  command->callback([&, verb] {
    code = thimble::cli::run_piece_action(arguments.socket_path, verb, arguments.world);
  });
}

void add_piece_commands(CLI::App& app, Arguments& arguments, int& code) {
  add_piece_command(app, "select", "Take the piece that the hand presses", arguments, code);
  add_piece_command(app, "drop", "Let go of the held piece where it is", arguments, code);
  add_piece_command(app, "delete", "Take the held piece out of the world", arguments, code);
  add_piece_command(app, "free", "Switch free motion, through everything, on or off", arguments,
                    code, true);
  add_piece_command(app, "reset", "Put all pieces where they were at first", arguments, code, true);
}

// CLI11 takes "-.01" for an option, "-0.01" for a number.
std::vector<std::string> with_leading_zeros(int argc, char** argv) {
  std::vector<std::string> words(argv, argv + argc);
  for (std::string& word : words) {
    const bool is_number =
        word.starts_with("-.") && thimble::cli::refuse_finite_number(word).empty();
    if (is_number) word.insert(1, "0");
  }
  return words;
}

int run(int argc, char** argv) {
  Arguments arguments;
  int code = kExitOk;
  CLI::App app("Talks to thimbled, the haptics daemon");
  app.set_version_flag("--version", std::string("thimble ") + THIMBLE_VERSION);
  arguments.socket_path = thimble::config::client_socket_path();
  app.add_option("--socket", arguments.socket_path, "Socket of the daemon")->capture_default_str();
  app.require_subcommand(1);
  app.fallthrough();  // options of the program may follow the subcommand
  add_status_commands(app, arguments, code);
  add_machine_commands(app, arguments, code);
  add_flight_commands(app, arguments, code);
  thimble::cam::add_cam_commands(app, code);
  thimble::lab_commands::add_lab_commands(app, code);
  add_arm_command(app, "activate", "Keep an arm active while this runs", arguments, code);
  add_arm_command(app, "deactivate", "Take the force off an arm", arguments, code);
  add_arm_command(app, "clear-fault", "Clear a latched fault whose cause is gone", arguments, code)
      ->add_option("--fault", arguments.fault,
                   "Only this one, as the status numbers it; default: the one latched now")
      ->check(refuse_no_fault);
  add_impedance_command(app, arguments, code);
  add_calibrate_command(app, arguments, code);
  add_world_command(app, arguments, code);
  thimble::picture::add_snapshot_command(app, arguments.socket_path, code);
  add_piece_commands(app, arguments, code);
  app.footer(
      "Exit codes: 0 done, 1 refused, not printed or (doctor) something wrong, 2 wrong arguments, "
      "3 no daemon.");
  app.failure_message(
      [](const CLI::App* of, const CLI::Error& error) {  // with what was given in it
        const std::string mistyped = thimble::cli::tell_mistyped(*of);
        return thimble::linux::printable_lines(
            mistyped.empty() ? CLI::FailureMessage::simple(of, error)
                             : mistyped + "\nRun with --help for more information.\n");
      });
  try {
    std::vector<std::string> words = with_leading_zeros(argc, argv);
    std::vector<char*> pointers;
    pointers.reserve(words.size());
    for (std::string& word : words) pointers.push_back(word.data());
    app.parse(argc, pointers.data());
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kExitOk : kExitUsage;
  }
  return code;
}

// What was printed and lost is no success. A reader that went away (thimble status | head) is told
// of as a shell expects it: by the signal.
int finish(int code) {
  const thimble::Result<void> written = thimble::linux::flush_standard_output();
  if (written) return code;
  if (written.error().code == thimble::Errc::Disconnected) {
    std::signal(SIGPIPE, SIG_DFL);
    std::raise(SIGPIPE);
  }
  std::cerr << "thimble: " << written.error().message << '\n';
  return code == kExitOk ? kExitRefused : code;
}

}  // namespace

int main(int argc, char** argv) {
  thimble::linux::occupy_closed_standard_descriptors();
  // Not during the work: a signal would leave the terminal of `watch` without its repair.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is one that cannot be written
  try {
    return finish(run(argc, argv));
  } catch (const std::bad_alloc&) {
    std::cerr << "thimble: there is not enough memory\n";
    return kExitRefused;
  } catch (const std::exception& error) {
    std::cerr << "thimble: " << error.what() << '\n';
    return kExitRefused;
  }
}
