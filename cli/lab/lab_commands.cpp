#include "cli/lab/lab_commands.hpp"

#include <cmath>
#include <cstdint>
#include <iostream>
#include <memory>
#include <string>

#include "cli/cells.hpp"
#include "cli/commands.hpp"
#include "cli/file_text.hpp"
#include "cli/lab/experiment_command.hpp"
#include "cli/numbers.hpp"
#include "cli/text.hpp"
#include "drivers/cambus/cambus_registers.hpp"
#include "hal/linux/monotonic_clock.hpp"
#include "lab/compare/compare.hpp"
#include "lab/constraint_models/constraint_models.hpp"
#include "lab/drift/drift.hpp"
#include "lab/hello_sphere/hello_sphere.hpp"
#include "lab/piece_separator.hpp"
#include "lab/run/run.hpp"
#include "lab/stability/stability.hpp"
#include "lab/table_4_1/table_4_1.hpp"
#include "lab/teleoperation/teleoperation.hpp"

namespace thimble::lab_commands {
namespace {

using cli::kExitOk;
using cli::kExitRefused;

void add_cam_latency(CLI::App& app, int& code) {
  CLI::App* latency = app.add_subcommand(
      "cam-latency", "Haptic updates on a simulated CAM-8, beside those of thesis 4.2");
  const auto clock_mhz = std::make_shared<int>(cambus::kClocks_mhz.back());
  latency->add_option("--clock-mhz", *clock_mhz, "Of the boards")
      ->check(cli::refuse_finite_number)
      ->check(CLI::IsMember(cambus::kClocks_mhz))
      ->capture_default_str();
  latency->callback(
      [&code, clock_mhz] { code = print_cam_latency(lab::report_cam_latency(*clock_mhz)); });
}

void add_separate(CLI::App& app, int& code) {
  struct Said {
    std::uint64_t seed{1};
    std::string write;
  };
  const auto said = std::make_shared<Said>();
  CLI::App* separate = app.add_subcommand(
      "separate", "Move interlocking pieces at random until all are apart (thesis 4.2.1)");
  separate->add_option("--seed", said->seed, "Of the pieces and the moves")
      ->check(cli::refuse_other_than_seed)
      ->capture_default_str();
  separate
      ->add_option(
          "--write", said->write,
          "Instead: the pieces before they are moved, to a file for world.pieces.layout: .npy or "
          ".nrrd")
      ->type_name("FILE")
      ->check(cli::refuse_empty_name);
  separate->callback([&code, said] { code = run_separate(said->seed, said->write); });
}

}  // namespace

int print_cam_latency(const Result<lab::CamLatencyReport>& report) {
  if (!report) {
    std::cerr << "thimble: " << report.error().message << '\n';
    return kExitRefused;
  }
  std::cout << report->text;
  return report->is_within ? kExitOk : kExitRefused;
}

Result<std::string> layout_file(std::uint64_t seed, const std::string& name) {
  const bool is_npy = name.ends_with(".npy");
  if (!is_npy && !name.ends_with(".nrrd")) {
    return fail(Errc::InvalidArgument, "a layout is written to a file ending in .npy or .nrrd");
  }
  return lab::separator_layout(seed).map([&](const world::cam::PieceLayout& layout) {
    cli::WorldCells cells{{}, 1, {layout.begin(), layout.end()}};
    for (std::size_t axis = 0; axis < cells.sizes.size(); ++axis) {
      cells.sizes[axis] = 1U << lab::kSeparatorSpace.log2_cells[axis];
    }
    return is_npy ? cli::to_npy(cells) : cli::to_nrrd(cells);
  });
}

int run_separate(std::uint64_t seed, const std::string& write) {
  if (!write.empty()) {
    const auto written = layout_file(seed, write).and_then([&](const std::string& content) {
      return cli::write_whole(write, content);
    });
    if (!written) {
      std::cerr << "thimble: " << cli::plain(written.error().in(write).message) << '\n';
      return kExitRefused;
    }
    std::cout << "the pieces are written to " << cli::plain(write) << '\n';
    return kExitOk;
  }
  const auto report = lab::report_separator(seed);
  if (!report) {
    std::cerr << "thimble: " << report.error().message << '\n';
    return kExitRefused;
  }
  std::cout << *report;
  return kExitOk;
}

// Of an experiment that is asked for nothing but its seed.
template <class Settings, class Run>
Experiment with_seed(const Run& run) {
  return [run](const Asked& asked) {
    Settings settings;
    settings.seed = asked.seed;
    settings.progress = asked.progress;
    return run(settings);
  };
}

// compare before both walls, and with each guard.
void add_comparisons(CLI::App& lab, int& code) {
  struct Comparison {
    const char* name;
    const char* help;
    bool moves;
    lab::Guard guard;
  };
  using lab::Guard;
  for (const Comparison& one :
       {Comparison{"compare", "Every coupling scheme at 1 to 500 ms on four networks, ranked",
                   false, Guard::None},
        {"compare-moving", "The same at a wall that moves to and fro", true, Guard::None},
        {"compare-guarded", "The same as compare, each scheme with a passivity guard", false,
         Guard::AtHand},
        {"compare-moving-guarded", "The same as compare-moving, each scheme with a passivity guard",
         true, Guard::AtHand},
        {"compare-two-port",
         "The same as compare, guarded at both ends where the world tells a force", false,
         Guard::BothEnds},
        {"compare-moving-two-port",
         "The same as compare-moving, guarded at both ends where the world tells a force", true,
         Guard::BothEnds}}) {
    const auto run = [moves = one.moves, guard = one.guard](const Asked& asked) {
      return lab::run_compare(
          {.moves = moves, .guard = guard, .seed = asked.seed, .progress = asked.progress});
    };
    add_experiment(lab, {.name = one.name, .help = one.help, .run = run}, code);
  }
}

void add_experiments(CLI::App& lab, int& code) {
  add_experiment(
      lab,
      {.name = "table-4.1",
       .help = "How far a wall that is learned of late displaces the frame (thesis 4.1)",
       .contacts = 1000,
       .run =
           [](const Asked& asked) {
             return lab::run_table_4_1(
                 {.contacts = asked.contacts, .seed = asked.seed, .progress = asked.progress});
           }},
      code);
  add_comparisons(lab, code);
  add_experiment(
      lab,
      {.name = "constraint-models",
       .help = "What holds a hand at cells, corners and edges (thesis 3.7, figures 3-7 to 3-10)",
       .run = [](const Asked& asked) { return lab::run_constraint_models({asked.seed}); }},
      code);
  add_experiment(
      lab,
      {.name = "teleoperation",
       .help = "Two arms coupled to each other, at 1 to 500 ms (thesis 5.3.5)",
       .run =
           [](const Asked& asked) {
             return lab::run_teleoperation({.seed = asked.seed, .progress = asked.progress});
           }},
      code);
}

void add_seeded_experiments(CLI::App& lab, int& code) {
  add_experiment(lab,
                 {.name = "stability",
                  .help = "The largest stable stiffness of each scheme over delay, beside theory",
                  .run = with_seed<lab::StabilitySettings>(lab::run_stability)},
                 code);
  add_experiment(lab,
                 {.name = "hello-sphere",
                  .help = "The ball of thesis 3.2 through each scheme, at 1 to 200 ms",
                  .run = with_seed<lab::HelloSphereSettings>(lab::run_hello_sphere)},
                 code);
  add_experiment(lab,
                 {.name = "drift",
                  .help = "Repeated taps at a wall that is learned of late (thesis 3.7)",
                  .run = with_seed<lab::DriftSettings>(lab::run_drift)},
                 code);
}

// Plays it; the exit code. How fast it went is printed only: files are the same each time.
int play_session(const lab::RunSettings& settings, const std::string& folder) {
  const auto run = lab::SessionRun::load(settings);
  if (!run) return finish_experiment(tl::unexpected(run.error()), folder);
  if (!prepare_folder(folder)) return kExitRefused;
  const linux::MonotonicClock clock;
  const MonotonicTime began = clock.now();
  (*run)->play(shown_progress());
  const double took_s = seconds(clock.now() - began);
  const int code = finish_experiment((*run)->findings(), folder);
  std::cout << "virtual time went " << std::lround(settings.for_s / took_s)
            << " times as fast as real time\n";
  return code;
}

void add_run(CLI::App& lab, int& code) {
  struct Said {
    lab::RunSettings settings;
    std::string folder;
  };
  const auto said = std::make_shared<Said>();
  CLI::App* run = lab.add_subcommand("run", "Play any configuration of the daemon in virtual time");
  run->add_option("CONFIG", said->settings.files,
                  "As thimbled takes it; several are hosts that talk to each other")
      ->required();
  run->add_option("--set", said->settings.overrides,
                  "KEY=VALUE, as thimbled takes it; NAME:KEY=VALUE for NAME.toml alone")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  run->add_option("--seed", said->settings.seed,
                  "Of all simulated persons and networks, instead of those of the file")
      ->check(cli::refuse_other_than_seed);
  run->add_option("--for", said->settings.for_s, "How long, in virtual seconds")
      ->check(cli::refuse_finite_number)
      ->check(CLI::Range(0.001, 1e5))
      ->capture_default_str();
  add_out(*run, said->folder);
  run->callback([&code, said] { code = play_session(said->settings, said->folder); });
}

void add_lab_commands(CLI::App& app, int& code) {
  CLI::App* lab = app.add_subcommand("lab", "Measure the thesis's figures in virtual time");
  lab->require_subcommand(1);
  add_cam_latency(*lab, code);
  add_separate(*lab, code);
  add_experiments(*lab, code);
  add_seeded_experiments(*lab, code);
  add_run(*lab, code);
}

}  // namespace thimble::lab_commands
