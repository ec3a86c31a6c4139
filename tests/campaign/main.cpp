#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "cli/numbers.hpp"
#include "hal/linux/monotonic_clock.hpp"
#include "tests/campaign/campaign.hpp"
#include "tests/campaign/planted_breach.hpp"
#include "tests/campaign/report.hpp"
#include "tests/campaign/shrink.hpp"

namespace {

namespace campaign = thimble::campaign;

constexpr int kExitKept = 0;
constexpr int kExitBroken = 1;
constexpr int kExitUsage = 2;
constexpr int kExitBlind = 3;
constexpr const char* kPlant = " --plant-breach";

struct Arguments {
  campaign::Order order;
  std::optional<std::uint64_t> episode;
  std::uint64_t least_judged{0};
  bool is_every_fault_due{false};
  bool is_breach_planted{false};
  bool is_to_shrink{true};
  bool is_quiet{false};
};

void say(const std::string& text) {
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
}

campaign::Planted planted_of(const Arguments& arguments) {
  return arguments.is_breach_planted ? campaign::planted_breach() : campaign::Planted{};
}

void say_failure(const Arguments& arguments, const campaign::Failure& failure) {
  const std::string replay = "./run campaign --seed " + std::to_string(arguments.order.seed) +
                             " --episode " + std::to_string(failure.episode) +
                             (arguments.is_breach_planted ? kPlant : "");
  say("\nBROKEN: " + campaign::to_text(*failure.ending.breach) + "\nreplay: " + replay + "\n");
  if (!arguments.is_to_shrink) return;
  say("shrinking ...\n");
  const campaign::Planted planted = planted_of(arguments);
  const auto play = [&planted](const campaign::Programme& programme) {
    return campaign::play(programme, planted).breach;
  };
  const auto shrunk = campaign::shrink(failure.programme, play);
  if (!shrunk) {
    say("it did not break again: it is not deterministic, which is a defect of its own\n");
    return;
  }
  say("after " + std::to_string(shrunk->plays) + " plays\n" + to_text(shrunk->programme) +
      "break " + to_text(shrunk->breach) + "\n");
}

int run_one(const Arguments& arguments) {
  campaign::Failure one;
  one.episode = *arguments.episode;
  one.programme = campaign::programme_of(arguments.order, one.episode);
  say(to_text(one.programme));
  one.ending = campaign::play(one.programme, planted_of(arguments));
  say(campaign::to_text(one.ending.tally) + "trace " + std::to_string(one.ending.trace) + "\n");
  if (!one.ending.breach) return kExitKept;
  say_failure(arguments, one);
  return kExitBroken;
}

// The processor's time of all jobs: how fast one core is, whoever else is on the machine.
double core_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// Why nothing can be said for what broke no rule; empty when it was seen enough.
std::string blindness(const Arguments& arguments, const campaign::Tally& tally) {
  const std::uint64_t judged = tally.judged.touches;
  if (judged < arguments.least_judged) {
    return "the work of " + std::to_string(judged) + " touches was judged, instead of " +
           std::to_string(arguments.least_judged) + " at least";
  }
  if (!arguments.is_every_fault_due) return "";
  std::string missing;
  for (const std::string& name : campaign::never_struck(tally)) {
    missing += (missing.empty() ? "never struck: " : ", ") + name;
  }
  return missing;
}

int run_all(const Arguments& arguments) {
  const thimble::linux::MonotonicClock clock;
  const thimble::MonotonicTime started = clock.now();
  thimble::MonotonicTime told = started;
  const auto progress = [&](const campaign::Tally& tally) {
    if (arguments.is_quiet || clock.now() - told < std::chrono::seconds(10)) return;
    told = clock.now();
    say(std::to_string(tally.ticks) + " of " + std::to_string(arguments.order.ticks) + " ticks\n");
  };
  const campaign::Outcome outcome = campaign::run(arguments.order, planted_of(arguments), progress);
  const double wall_s = thimble::seconds(clock.now() - started);
  say(campaign::to_text(outcome.tally) + "trace " + std::to_string(outcome.trace) + "\n");
  char speed[160];
  std::snprintf(speed, sizeof speed, "%.1f s: %.0f x real time, %.0f x on each core\n", wall_s,
                outcome.tally.played_s / wall_s, outcome.tally.played_s / core_s());
  say(speed);
  if (!outcome.failure) {
    const std::string blind = blindness(arguments, outcome.tally);
    if (!blind.empty()) {
      say("BLIND: " + blind + "\n");
      return kExitBlind;
    }
    say("no rule was broken\n");
    return kExitKept;
  }
  say_failure(arguments, *outcome.failure);
  return kExitBroken;
}

template <std::uint64_t Least>
std::string refuse_less_than(const std::string& text) {
  return thimble::cli::refuse_whole_number(text, Least, std::numeric_limits<std::uint64_t>::max());
}

std::string refuse_jobs(const std::string& text) {
  return thimble::cli::refuse_whole_number(text, 1, 256);
}

void add_options(CLI::App& app, Arguments& arguments) {
  // Without a tick no rule is broken either: that would be a success of nothing.
  app.add_option("--ticks", arguments.order.ticks, "Ticks in all")
      ->check(refuse_less_than<1>)
      ->capture_default_str();
  app.add_option("--seed", arguments.order.seed, "Seed of the campaign")
      ->check(refuse_less_than<0>)
      ->capture_default_str();
  app.add_option("--episode", arguments.episode, "Play this one again, and nothing else")
      ->check(refuse_less_than<0>);
  app.add_option("--jobs", arguments.order.jobs, "Episodes at a time")
      ->check(refuse_jobs)
      ->capture_default_str();
  app.add_option("--least-judged", arguments.least_judged,
                 "Touches whose work must have been judged, or it ends in failure")
      ->check(refuse_less_than<0>);
  app.add_flag("--every-fault", arguments.is_every_fault_due,
               "Each kind of fault must have struck, or it ends in failure");
  app.add_flag("!--no-shrink", arguments.is_to_shrink, "Leave a failing episode as it is");
  // Of no use to a person: it shows what a campaign does that fails (test_replay.py).
  app.add_flag("--plant-breach", arguments.is_breach_planted)->group("");
  app.add_flag("--quiet", arguments.is_quiet, "Say nothing before the end");
}

// The C library picks its sines by processor, and their last bits differ: an episode would be
// another one elsewhere. It looks at this variable once, when a program starts.
void hold_sines_to_one_choice(char** argv) {
  constexpr const char* kName = "GLIBC_TUNABLES";
  constexpr const char* kChoice = "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F";
  const char* const now = std::getenv(kName);
  if (now != nullptr && std::string_view(now) == kChoice) return;
  if (setenv(kName, kChoice, 1) == 0) execv("/proc/self/exe", argv);
  say("the trace may differ from that of another processor: this one's sines are used\n");
}

}  // namespace

int main(int argc, char** argv) {
  hold_sines_to_one_choice(argv);
  Arguments arguments;
  CLI::App app{
      "Plays episodes of random faults in virtual time while a simulated hand explores, and "
      "judges every tick (docs/campaign.md)"};
  add_options(app, arguments);
  try {
    app.parse(argc, argv);
    return arguments.episode ? run_one(arguments) : run_all(arguments);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kExitKept : kExitUsage;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "campaign: %s\n", error.what());
    return kExitUsage;
  }
}
