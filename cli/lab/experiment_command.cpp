#include "cli/lab/experiment_command.hpp"

#include <unistd.h>

#include <iostream>
#include <memory>

#include "cli/commands.hpp"
#include "cli/file_text.hpp"
#include "cli/lab/findings_files.hpp"
#include "cli/numbers.hpp"
#include "cli/text.hpp"

namespace thimble::lab_commands {
namespace {

constexpr std::size_t kBarColumns = 40;

std::string refuse_no_contacts(const std::string& text) {
  return cli::refuse_whole_number(text, 1, 1'000'000);
}

}  // namespace

lab::Progress shown_progress() {
  if (::isatty(STDERR_FILENO) != 1) return {};
  return [](std::size_t done, std::size_t all) {
    const double share = static_cast<double>(done) / static_cast<double>(all);
    std::cerr << '\r' << cli::bar(share, kBarColumns, cli::Glyphs::Ascii) << ' ' << done << " of "
              << all;
    if (done == all) std::cerr << "\r\x1b[K";
    std::cerr << std::flush;
  };
}

void add_out(CLI::App& command, std::string& folder) {
  command
      .add_option("--out", folder, "Write CSV, JSON and plots (SVG and PNG, by gnuplot) there, too")
      ->type_name("FOLDER")
      ->check(cli::refuse_empty_name);
}

bool prepare_folder(const std::string& folder) {
  if (folder.empty()) return true;
  const auto made = make_folder(folder);
  if (!made) std::cerr << "thimble: " << cli::plain(made.error().message) << '\n';
  return made.has_value();
}

int finish_experiment(const Result<lab::Findings>& findings, const std::string& folder) {
  if (!findings) {
    std::cerr << "thimble: " << cli::plain(findings.error().message) << '\n';
    return cli::kExitRefused;
  }
  std::cout << lab::tell(*findings);
  if (!folder.empty()) {
    const auto written = write_findings(*findings, folder);
    if (!written) {
      std::cerr << "thimble: " << cli::plain(written.error().message) << '\n';
      return cli::kExitRefused;
    }
    for (const std::string& file : written->files)
      std::cout << "written: " << cli::plain(file) << '\n';
    if (!written->not_drawn.empty()) std::cerr << "thimble: " << written->not_drawn << '\n';
  }
  return findings->is_met() ? cli::kExitOk : cli::kExitRefused;
}

void add_experiment(CLI::App& lab, const ExperimentCommand& of, int& code) {
  struct Said {
    Asked asked;
    std::string folder;
  };
  const auto said = std::make_shared<Said>();
  said->asked.contacts = of.contacts;
  CLI::App* command = lab.add_subcommand(of.name, of.help);
  command->add_option("--seed", said->asked.seed, "Of everything that is random")
      ->check(cli::refuse_other_than_seed)
      ->capture_default_str();
  if (of.contacts > 0) {
    command->add_option("--contacts", said->asked.contacts, "Of each row of the table")
        ->check(refuse_no_contacts)
        ->capture_default_str();
  }
  add_out(*command, said->folder);
  command->callback([&code, said, run = of.run] {
    if (!prepare_folder(said->folder)) {
      code = cli::kExitRefused;
      return;
    }
    said->asked.progress = shown_progress();
    code = finish_experiment(run(said->asked), said->folder);
  });
}

}  // namespace thimble::lab_commands
