#include <unistd.h>

#include <algorithm>
#include <boost/json.hpp>
#include <iostream>

#include "cli/cam/run.hpp"
#include "cli/commands.hpp"
#include "cli/file_text.hpp"
#include "cli/text.hpp"

namespace thimble::cam {
namespace {

namespace json = boost::json;

json::array list_of(const sim::cam::PlaneCounts& counts) {
  return json::array(counts.begin(), counts.end());
}

double sites_per_s(const RunOptions& options, const RunReport& report) {
  if (report.host_s <= 0) return 0;
  return static_cast<double>(options.steps) * static_cast<double>(report.sites.size()) /
         report.host_s;
}

double board_time_s(const RunOptions& options, std::uint64_t clocks) {
  return static_cast<double>(clocks) / (1e6 * options.clock_mhz);
}

void print_json(const RunOptions& options, const RunReport& report) {
  json::object document{{"world", options.world},
                        {"size", options.size},
                        {"steps", options.steps},
                        {"seed", options.seed},
                        {"engine", report.path},
                        {"threads", options.threads},
                        {"population", list_of(report.population)},
                        {"counters", list_of(report.counters)},
                        {"host_s", report.host_s},
                        {"sites_per_s", sites_per_s(options, report)}};
  if (!report.kernels.empty()) document["instruction_set"] = report.kernels;
  if (report.board_clocks) {
    document["board"] = {{"modules", options.modules},
                         {"clock_mhz", options.clock_mhz},
                         {"clocks", *report.board_clocks},
                         {"time_s", board_time_s(options, *report.board_clocks)},
                         {"unmodelled", report.unmodelled}};
  }
  std::cout << json::serialize(document) << '\n';
}

void print_text(const RunOptions& options, const RunReport& report) {
  std::cout << options.world << ", " << options.size << " sites, " << options.steps << " steps by "
            << report.path << (report.kernels.empty() ? "" : " (" + report.kernels + ")")
            << (options.threads == 1 ? "" : " on " + std::to_string(options.threads) + " threads")
            << "\nlayer  population  counter of the last step\n";
  for (std::size_t layer = 0; layer < report.population.size(); ++layer) {
    if (report.population[layer] == 0 && report.counters[layer] == 0) continue;
    std::cout << cli::fit(std::to_string(layer), 7)
              << cli::fit(std::to_string(report.population[layer]), 12) << report.counters[layer]
              << '\n';
  }
  std::cout << "host   " << cli::time_text(report.host_s, cli::Glyphs::Ascii) << ", "
            << cli::fixed(sites_per_s(options, report) * 1e-6, 1) << " million sites a second\n";
  if (!report.board_clocks) return;
  const double time_s = board_time_s(options, *report.board_clocks);
  std::cout << "board  " << *report.board_clocks << " clocks, "
            << cli::time_text(time_s, cli::Glyphs::Ascii) << " at " << options.clock_mhz
            << " MHz on " << options.modules << (options.modules == 1 ? " module\n" : " modules\n");
}

// A line that is written over and over, as a file has no use for. Empty words: it goes again.
Progress shown_progress() {
  if (::isatty(STDERR_FILENO) != 1) return {};
  return [](const std::string& what) { std::cerr << "\r\x1b[K" << what << std::flush; };
}

Result<RunReport> run(const RunOptions& options, const Clock& clock, const Progress& progress) {
  const Rule* const rule = sim::cam::find_rule(options.world);
  if (rule == nullptr) {
    return fail(Errc::NotFound, "there is no world of this name: see thimble cam list");
  }
  const auto space = parse_size(options.size);
  if (!space) return tl::unexpected(space.error());
  // What cannot be written is said before the work.
  if (!options.write.empty()) {
    const auto file =
        to_file(*rule, *space, std::vector<std::uint16_t>(space->sites()), options.write);
    if (!file) return tl::unexpected(file.error().in(options.write));
  }
  auto report = run_world(*rule, *space, options, clock, progress);
  if (!report || options.write.empty()) return report;
  if (progress) progress("writing them to " + cli::plain(options.write));
  const auto written = to_file(*rule, *space, report->sites, options.write)
                           .and_then([&](const std::string& content) {
                             return cli::write_whole(options.write, content);
                           });
  if (!written) return tl::unexpected(written.error().in(options.write));
  return report;
}

}  // namespace

int run_run(const RunOptions& options, const Clock& clock) {
  const Progress progress = shown_progress();
  const auto report = run(options, clock, progress);
  if (progress) progress("");
  if (!report) {
    std::cerr << "thimble: " << cli::plain(options.world) << ": "
              << cli::plain(report.error().message) << '\n';
    return cli::kExitRefused;
  }
  std::cerr << log_of(report->unmodelled_touches);
  if (options.is_json) {
    print_json(options, *report);
  } else {
    print_text(options, *report);
  }
  return cli::kExitOk;
}

int run_list(bool is_json) {
  json::array names;
  for (const Rule& rule : sim::cam::rules()) {
    names.push_back({{"name", rule.name}, {"about", rule.about}});
    if (!is_json) std::cout << cli::fit(rule.name, 18) << rule.about << '\n';
  }
  if (is_json) std::cout << json::serialize(names) << '\n';
  return cli::kExitOk;
}

}  // namespace thimble::cam
