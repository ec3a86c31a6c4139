#include "cli/lab/lab_commands.hpp"

#include <cstdint>
#include <iostream>
#include <memory>
#include <string>

#include "cli/commands.hpp"
#include "drivers/cambus/cambus_registers.hpp"
#include "lab/piece_separator.hpp"

namespace thimble::lab_commands {
namespace {

using cli::kExitOk;
using cli::kExitRefused;

void add_cam_latency(CLI::App& app, int& code) {
  CLI::App* latency = app.add_subcommand(
      "cam-latency", "Haptic updates on a simulated CAM-8, beside those of thesis 4.2");
  const auto clock_mhz = std::make_shared<int>(cambus::kClocks_mhz.back());
  latency->add_option("--clock-mhz", *clock_mhz, "Of the boards")
      ->check(CLI::IsMember(cambus::kClocks_mhz))
      ->capture_default_str();
  latency->callback(
      [&code, clock_mhz] { code = print_cam_latency(lab::report_cam_latency(*clock_mhz)); });
}

void add_separate(CLI::App& app, int& code) {
  const auto seed = std::make_shared<std::uint64_t>(1);
  CLI::App* separate = app.add_subcommand(
      "separate", "Move interlocking pieces at random until all are apart (thesis 4.2.1)");
  separate->add_option("--seed", *seed, "Of the pieces and the moves")->capture_default_str();
  separate->callback([&code, seed] {
    const auto report = lab::report_separator(*seed);
    (report ? std::cout : std::cerr)
        << (report ? *report : "thimble: " + report.error().message + '\n');
    code = report ? kExitOk : kExitRefused;
  });
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

void add_lab_commands(CLI::App& app, int& code) {
  CLI::App* lab = app.add_subcommand("lab", "Measure the thesis's figures in virtual time");
  lab->require_subcommand(1);
  add_cam_latency(*lab, code);
  add_separate(*lab, code);
}

}  // namespace thimble::lab_commands
