#include "cli/calibrate_force.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "cli/ask.hpp"
#include "cli/client.hpp"
#include "cli/commands.hpp"
#include "cli/force_fit.hpp"
#include "cli/text.hpp"

namespace thimble::cli {
namespace {

// Ours: a person homes the arm meanwhile.
constexpr std::chrono::milliseconds kLook{200};
constexpr int kMostLooks = 600;
constexpr std::chrono::milliseconds kSettlingLook{20};
constexpr int kMostSettlingLooks = 100;
// Ours: so many counts a motor bears for as long as it likes, and a scale shows some 100 g for
// them.
constexpr double kMostCounts = 400;
constexpr double kMostNewton = 8;
constexpr double kLeastNewton = 0.5;  // that --most takes

// Of the default, from here on a force is it: it is shown with one digit behind the point.
constexpr double kAlmost = 0.999;

double default_newton(const api::ArmStatus& arm) {
  return std::min(kMostNewton, kMostCounts * arm.newton_per_count);
}

constexpr double kLeastRise_gram = 3;  // ours: less is the scale, or a hand at its side

std::string text_of(const char* format, double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

// What was found of the arm before its first force.
struct Beginning {
  double assumed_newton_per_count{0};
  double most_newton{0};
  bool is_trial{false};
};

// One arm that is measured, over one connection, whose end lets it go.
class Measurement {
 public:
  Measurement(Client& client, std::string arm, std::istream& typed)
      : client_(client), arm_(std::move(arm)), typed_(typed) {}

  // Errors: why the arm cannot be had, or is not one whose counts need measuring.
  [[nodiscard]] Result<Beginning> begin(const CalibrateOptions& options) {
    const auto status = find();
    if (!status) return tl::unexpected<Error>(status.error());
    const auto most_newton = strongest_force_newton(*status, options);
    if (!most_newton) return tl::unexpected<Error>(most_newton.error());
    const auto answer = post("activate", "");
    if (!answer) return tl::unexpected<Error>(answer.error());
    const auto active = wait_until_active();
    if (!active) return tl::unexpected<Error>(active.error());
    return Beginning{status->newton_per_count, *most_newton, is_trial(*status, options)};
  }

  [[nodiscard]] Result<std::vector<ScaleReading>> read_all(const std::vector<double>& steps) {
    std::cerr
        << "Put the scale under the grip, so high that the grip rests on it in the middle of its "
           "way. Steady it from the sides only.\n";
    std::vector<ScaleReading> readings;
    for (const double newton : steps) {
      const auto reading = read_one(newton);
      if (!reading) return tl::unexpected<Error>(reading.error());
      readings.push_back(*reading);
    }
    return readings;
  }

 private:
  [[nodiscard]] Result<std::string> post(const std::string& verb, const std::string& body) {
    return ask(client_, "POST", "/v1/arms/" + arm_ + "/" + verb, body);
  }

  [[nodiscard]] Result<api::ArmStatus> find() {
    const auto status = ask_status(client_);
    if (!status) return tl::unexpected<Error>(status.error());
    for (const api::ArmStatus& arm : status->arms) {
      if (arm.name == arm_) return arm;
    }
    return fail(Errc::InvalidArgument, "there is no arm " + arm_);
  }

  [[nodiscard]] Result<void> wait_until_active() {
    std::string told;
    std::string why = "thimble status says why";
    for (int looks = 0; looks < kMostLooks; ++looks) {
      const auto arm = find();
      if (!arm) return tl::unexpected<Error>(arm.error());
      if (arm->state == "active") return {};
      if (arm->state == "fault" || arm->state == "lost") break;
      // One that tells a way changes with each millimetre of it.
      const std::string kind = arm->instruction.substr(0, arm->instruction.find(':'));
      if (kind != told) std::cerr << plain(arm->instruction) << '\n';
      told = kind;
      if (!arm->instruction.empty()) why = plain(arm->instruction);
      std::this_thread::sleep_for(kLook);
    }
    return fail(Errc::Busy, "arm " + arm_ + " does not become active: " + why);
  }

  // Or until it is clear that it will not be: its motors are warm. The force that is given then.
  [[nodiscard]] Result<double> wait_until_pressed(double newton) {
    for (int looks = 0;; ++looks) {
      const auto arm = find();
      if (!arm) return tl::unexpected<Error>(arm.error());
      const double given_newton = -arm->force_newton[1];
      if (std::abs(given_newton - newton) < 1e-3 || looks == kMostSettlingLooks) {
        return given_newton;
      }
      std::this_thread::sleep_for(kSettlingLook);
    }
  }

  [[nodiscard]] Result<ScaleReading> read_one(double newton) {
    while (true) {
      const auto pressed = post("steady-force", "{\"up_newton\":" + text_of("%.6f", -newton) + "}");
      if (!pressed) return tl::unexpected<Error>(pressed.error());
      const auto given_newton = wait_until_pressed(newton);
      if (!given_newton) return tl::unexpected<Error>(given_newton.error());
      std::cerr << "pressing with " << text_of("%.1f", std::abs(*given_newton))
                << " N; the scale says, in grams: ";
      std::string line;
      if (!std::getline(typed_, line)) {
        return fail(Errc::InvalidArgument, "the input ended before the last reading");
      }
      const auto gram = parse_gram(line);
      if (!gram) {
        std::cerr << gram.error().message << '\n';
        continue;
      }
      // What the limiter lets through; motors that get warm are given less than was asked for.
      const auto arm = find();
      if (!arm) return tl::unexpected<Error>(arm.error());
      if (arm->state != "active") return fail(Errc::Busy, "arm " + arm_ + " is active no more");
      const double now_newton = -arm->force_newton[1];
      if (!has_ended(*given_newton, now_newton)) return ScaleReading{now_newton, *gram};
      std::cerr << "the force ended meanwhile, as it does after a minute; once more\n";
    }
  }

  // Of one that was given: warm motors give less, not nothing.
  static bool has_ended(double before_newton, double now_newton) {
    return std::abs(before_newton) > kLeastNewton / 2 &&
           std::abs(now_newton) < std::abs(before_newton) / 4;
  }

  Client& client_;
  std::string arm_;
  std::istream& typed_;
};

int print(const ForceScale& scale, double assumed_newton_per_count) {
  std::cerr << "Write this into the arm's table of the configuration, and restart the daemon. "
            << "It was " << text_of("%.3g", assumed_newton_per_count) << "; the arm alone weighs "
            << text_of("%.0f", scale.rest_gram) << " g on the scale, and the readings are "
            << text_of("%.2f", scale.worst_off_newton) << " N or less off their line.\n";
  std::cout << "newton_per_count = " << text_of("%.4g", scale.newton_per_count) << '\n';
  return kExitOk;
}

// Nothing on standard output, where a line would be taken for one to paste.
int tell_trial(const std::vector<ScaleReading>& readings) {
  const double more_gram = rise_gram(readings);
  const std::string shown = text_of("%.0f", std::abs(more_gram)) + " g";
  if (more_gram < kLeastRise_gram) {
    const bool is_up = more_gram <= -kLeastRise_gram;
    return complain({Errc::Busy, is_up ? "the scale shows " + shown +
                                             " less at the strongest force: the arm does not press "
                                             "down; stop here, and report it"
                                       : "the scale does not show that the arm presses down: does "
                                         "the grip rest on it? If it pressed aside, stop here"});
  }
  std::cerr << "The arm presses down: the scale shows " << shown
            << " more at the strongest force. That was only a trial of the direction; to measure a "
               "count, take arm.limits.force_newton out of its table, restart the daemon, and run "
               "thimble calibrate-force without --most.\n";
  return kExitOk;
}

tl::unexpected<Error> too_weak(const api::ArmStatus& arm, double most_newton) {
  const std::string limit = text_of("%.3g", arm.max_force_newton);
  const bool is_askable = arm.max_force_newton >= kLeastNewton;
  return fail(Errc::InvalidArgument,
              "arm " + arm.name + " is given " + limit + " N at most, and " +
                  text_of("%.1f", most_newton) +
                  " N is asked for: take arm.limits.force_newton out of its table" +
                  (is_askable ? ", or, to try its direction only, give --most " + limit : ""));
}

}  // namespace

Result<double> strongest_force_newton(const api::ArmStatus& arm, const CalibrateOptions& options) {
  // First: of an arm that is not there nothing else is known.
  if (arm.state == "lost") {
    return fail(Errc::Busy, "arm " + arm.name + " is lost: " + plain(arm.instruction));
  }
  if (arm.max_force_newton == 0) {
    return fail(Errc::InvalidArgument,
                "arm " + arm.name + " makes no force: there is nothing to measure with a scale");
  }
  if (!(arm.newton_per_count > 0)) {
    return fail(Errc::InvalidArgument,
                "arm " + arm.name + " is told amperes: there is nothing to measure with a scale");
  }
  const double most_newton = options.most_newton.value_or(default_newton(arm));
  if (arm.max_force_newton < most_newton) return too_weak(arm, most_newton);
  return most_newton;
}

bool is_trial(const api::ArmStatus& arm, const CalibrateOptions& options) {
  return options.most_newton && *options.most_newton < kAlmost * default_newton(arm);
}

int run_calibrate_force(const std::string& socket_path, const std::string& arm,
                        const CalibrateOptions& options, std::istream& typed) {
  auto client = connect_to_daemon(socket_path);
  if (!client) return complain(client.error());
  const Result<std::string> name = arm.empty() ? only_arm(**client) : Result<std::string>(arm);
  if (!name) return complain(name.error());
  Measurement measurement(**client, *name, typed);
  const auto begun = measurement.begin(options);
  if (!begun) return complain(begun.error());
  if (begun->is_trial) {
    std::cerr << "This is a trial of the direction only: no line for the configuration comes of so "
                 "little force.\n";
  }
  const auto readings = measurement.read_all(even_forces_newton(begun->most_newton, options.steps));
  if (!readings) return complain(readings.error());
  if (begun->is_trial) return tell_trial(*readings);
  const auto scale = fit_force(*readings, begun->assumed_newton_per_count);
  if (!scale) return complain(scale.error());
  return print(*scale, begun->assumed_newton_per_count);
}

}  // namespace thimble::cli
