#include "cli/cam/cam_commands.hpp"

#include <cstdint>
#include <memory>
#include <string>

#include "cli/cam/disassemble.hpp"
#include "cli/cam/run.hpp"
#include "cli/file_text.hpp"
#include "cli/numbers.hpp"
#include "drivers/cambus/cambus_registers.hpp"
#include "hal/linux/monotonic_clock.hpp"
#include "sim/model/cam/engine/plane_engine.hpp"

namespace thimble::cam {
namespace {

std::string refuse_no_threads(const std::string& text) {
  return cli::refuse_whole_number(text, 1, sim::cam::PlaneEngine::kMostThreads);
}

void add_world_commands(CLI::App& cam, int& code) {
  const auto said = std::make_shared<RunOptions>();
  RunOptions& options = *said;
  CLI::App* list = cam.add_subcommand("list", "Name the worlds that run without an arm");
  list->add_flag("--json", options.is_json, "As a JSON document");
  list->callback([&code, said] { code = run_list(said->is_json); });

  CLI::App* run = cam.add_subcommand("run", "Run a world, and say what came of it and how fast");
  run->add_option("WORLD", options.world, "One of thimble cam list")->required();
  run->add_option("--size", options.size, "Sites along x, y and z: powers of two, 512x512")
      ->required();
  run->add_option("--steps", options.steps, "How many")
      ->check(cli::refuse_other_than_whole)
      ->required();
  run->add_option("--seed", options.seed, "Of what is random")
      ->check(cli::refuse_other_than_whole)
      ->capture_default_str();
  run->add_option("--pattern", options.pattern,
                  "Begin with this in the middle: .rle, .npy, .nrrd or .nhdr")
      ->type_name("FILE")
      ->check(cli::refuse_empty_name);
  run->add_option("--engine", options.engine, "Which does the work; all do the same")
      ->check(CLI::IsMember({"reference", "general", "compiled", "auto"}))
      ->capture_default_str();
  run->add_option("--threads", options.threads, "Of this machine: they share a scan that is large")
      ->check(refuse_no_threads)
      ->capture_default_str();
  run->add_option("--modules", options.modules, "Of the board whose clocks are counted")
      ->check(cli::refuse_other_than_whole)
      ->check(CLI::IsMember({1, 2, 4, 8, 16, 32, 64}))
      ->capture_default_str();
  run->add_option("--clock-mhz", options.clock_mhz, "Of that board")
      ->check(cli::refuse_finite_number)
      ->check(CLI::IsMember(cambus::kClocks_mhz))
      ->capture_default_str();
  run->add_option("--write", options.write, "What came of it, to a file: .npy or .rle")
      ->type_name("FILE")
      ->check(cli::refuse_empty_name);
  run->add_flag("--json", options.is_json, "As a JSON document");
  run->callback([&code, said] { code = run_run(*said, linux::MonotonicClock()); });
}

void add_disassemble(CLI::App& cam, int& code) {
  struct Said {
    std::string file;
    cambus::ListLimits board;
    int log2_sites{cambus::kLog2ModuleSites.front()};
  };
  const auto said = std::make_shared<Said>();
  CLI::App* disassemble =
      cam.add_subcommand("disassemble", "Tell what a step list does, and whether a board takes it");
  disassemble->add_option("FILE", said->file, "Of the form in docs/cambus.md, section 3")
      ->required();
  disassemble->add_flag("--sync", said->board.has_sync,
                        "The board's sync pulses run: synchronised scans come to an end");
  disassemble
      ->add_option("--sites", said->log2_sites, "Sites of a module, as a power of two: 22 or 24")
      ->check(cli::refuse_other_than_whole)
      ->check(CLI::IsMember(cambus::kLog2ModuleSites))
      ->capture_default_str();
  disassemble->callback([&code, said] {
    said->board.module_sites = std::uint32_t{1} << said->log2_sites;
    code = run_disassemble(said->file, said->board);
  });
}

}  // namespace

void add_cam_commands(CLI::App& app, int& code) {
  CLI::App* cam = app.add_subcommand("cam", "Run worlds of a CAM, look at programs of its board");
  cam->require_subcommand(1);
  add_world_commands(*cam, code);
  add_disassemble(*cam, code);
}

}  // namespace thimble::cam
