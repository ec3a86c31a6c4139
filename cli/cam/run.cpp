#include "cli/cam/run.hpp"

#include <bit>
#include <charconv>
#include <chrono>
#include <memory>

#include "cli/cam/board_engine.hpp"
#include "sim/model/cam/engine/plane_engine.hpp"

namespace thimble::cam {
namespace {

using sim::cam::Engine;
using sim::cam::PlaneCounts;
using sim::cam::PlaneEngine;
using sim::cam::SiteSpace;
using sim::cam::TablePath;

// Or to tell of small steps would take longer than they do.
constexpr Duration kBetweenTellings = std::chrono::milliseconds(100);

void tell(const Progress& progress, const std::string& what) {
  if (progress) progress(what);
}

class StepTeller {
 public:
  StepTeller(const Clock& clock, const Progress& progress) : clock_(clock), progress_(progress) {}
  void tell(std::uint64_t step, std::uint64_t steps) {
    if (!progress_) return;
    const MonotonicTime now = clock_.now();
    if (step > 0 && now < next_) return;
    next_ = now + kBetweenTellings;
    progress_("step " + std::to_string(step + 1) + " of " + std::to_string(steps));
  }

 private:
  const Clock& clock_;
  const Progress& progress_;
  MonotonicTime next_{};
};

// Takes the steps; the counters of the last one.
Result<PlaneCounts> take_steps(Engine& engine, const Rule& rule, std::uint64_t steps,
                               bool counts_last, StepTeller* teller) {
  PlaneCounts counters{};
  for (std::uint64_t step = 0; step < steps; ++step) {
    if (teller != nullptr) teller->tell(step, steps);
    const bool counts = counts_last && step + 1 == steps;
    const auto counted = engine.step(
        rule.cycle[step % rule.cycle.size()],
        {.counting = counts ? sim::cam::Counting::Outputs : sim::cam::Counting::Nothing});
    if (!counted) return tl::unexpected(counted.error());
    counters = *counted;
  }
  return counters;
}

// The same steps on a board that keeps only time.
struct BoardTime {
  std::uint64_t clocks{0};
  std::uint64_t unmodelled{0};
  std::vector<sim::cam::UnmodelledTouch> touches;
};

Result<BoardTime> time_of(const Rule& rule, const SiteSpace& space, const RunOptions& options) {
  const auto board = BoardEngine::make(space, options.modules, BoardEngine::Keeps::OnlyTime);
  if (!board) return tl::unexpected(board.error());
  // The table is sent before the clocks are looked at.
  if (const auto shown = (*board)->show_table(0); !shown) return tl::unexpected(shown.error());
  const std::uint64_t before = (*board)->clocks();
  const auto taken = take_steps(**board, rule, options.steps, false, nullptr);
  if (!taken) return tl::unexpected(taken.error());
  return BoardTime{(*board)->clocks() - before, (*board)->unmodelled(),
                   (*board)->unmodelled_touches()};
}

Result<std::unique_ptr<Engine>> make_engine(const SiteSpace& space, const RunOptions& options) {
  if (options.engine == "reference") {
    if (options.threads != 1) {
      return fail(Errc::InvalidArgument, "the reference engine has one thread");
    }
    auto board = BoardEngine::make(space, options.modules);
    if (!board) return tl::unexpected(board.error());
    return std::unique_ptr<Engine>(std::move(*board));
  }
  const TablePath path = options.engine == "general"    ? TablePath::General
                         : options.engine == "compiled" ? TablePath::Compiled
                                                        : TablePath::Auto;
  auto planes =
      PlaneEngine::make(space, path, *sim::cam::usable_kernels().front(), options.threads);
  if (!planes) return tl::unexpected(planes.error());
  return std::unique_ptr<Engine>(std::move(*planes));
}

}  // namespace

std::string log_of(const std::vector<sim::cam::UnmodelledTouch>& touches) {
  std::string log;
  for (const sim::cam::UnmodelledTouch& touch : touches) {
    log += "the simulated board does not model what register '" +
           std::string(cambus::facts_of(touch.of).name) + "' was set to at clock " +
           std::to_string(touch.at_clocks) + "\n";
  }
  return log;
}

Result<SiteSpace> parse_size(const std::string& text) {
  SiteSpace space;
  std::string_view rest = text;
  for (std::size_t axis = 0; axis < 3 && !rest.empty(); ++axis) {
    std::uint32_t length = 0;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), length);
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    const bool goes_on = rest.starts_with('x') && rest.size() > 1;
    if (error != std::errc{} || !std::has_single_bit(length) || (!rest.empty() && !goes_on)) break;
    space.log2_cells[axis] = std::countr_zero(length);
    if (rest.empty()) return sim::cam::check_space(space).map([&] { return space; });
    rest.remove_prefix(1);
  }
  return fail(Errc::InvalidArgument,
              "a size is one to three powers of two, as in 512x512 or 64x64x64");
}

Result<RunReport> run_world(const Rule& rule, const SiteSpace& space, const RunOptions& options,
                            const Clock& clock, const Progress& progress) {
  tell(progress, "making the first sites");
  const auto sites = first_sites(rule, space, options);
  if (!sites) return tl::unexpected(sites.error());
  const auto engine = make_engine(space, options);
  if (!engine) return tl::unexpected(engine.error());
  if (const auto loaded = (*engine)->load(0, sim::cam::table_of(rule)); !loaded) {
    return tl::unexpected(loaded.error());
  }
  if (const auto put = (*engine)->put(*sites); !put) return tl::unexpected(put.error());
  StepTeller teller(clock, progress);
  const MonotonicTime start = clock.now();
  const auto counters = take_steps(**engine, rule, options.steps, true, &teller);
  if (!counters) return tl::unexpected(counters.error());
  RunReport report;
  report.host_s = seconds(clock.now() - start);
  tell(progress, "counting what came of it");
  report.counters = *counters;
  report.population = (*engine)->population();
  report.path = "board";
  if (const auto* planes = dynamic_cast<const PlaneEngine*>(engine->get())) {
    report.path = planes->compiled_ops(0) ? "compiled" : "table";
    report.kernels = sim::cam::usable_kernels().front()->name;
  }
  tell(progress, "counting the clocks of a board");
  if (const auto board = time_of(rule, space, options)) {
    report.board_clocks = board->clocks;
    report.unmodelled = board->unmodelled;
    report.unmodelled_touches = board->touches;
  }
  tell(progress, "taking the sites out");
  report.sites.resize(space.sites());
  if (const auto got = (*engine)->get(report.sites); !got) return tl::unexpected(got.error());
  return report;
}

}  // namespace thimble::cam
