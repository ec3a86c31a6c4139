#include "lab/run/run.hpp"

#include <cmath>
#include <filesystem>
#include <set>
#include <string_view>
#include <utility>

#include "daemon/config/load.hpp"
#include "daemon/session/inspect.hpp"
#include "lab/run/playable.hpp"

namespace thimble::lab {
namespace {

constexpr std::uint64_t kToldEvery = 1000;  // ticks

std::string in_one_line(const std::vector<std::string>& lines, const char* between = "; ") {
  std::string text;
  for (const std::string& line : lines) text += (text.empty() ? "" : between) + line;
  return text;
}

void seed_all(std::vector<PlayedFile>& files, std::uint64_t seed) {
  for (PlayedFile& file : files) {
    for (config::ArmConfig& arm : file.config.arms) {
      if (arm.hand) arm.hand->seed = seed;
      if (arm.impairment) arm.impairment->seed = seed;
      ++seed;
    }
  }
  for (PlayedFile& file : files) {
    for (config::WorldConfig& world : file.config.worlds) {
      if (world.impairment) world.impairment->seed = seed++;
    }
  }
}

// "right" of "right:arm.hand.seed=1"; empty: it is for every file.
std::string_view addressee(std::string_view override) {
  const std::size_t colon = override.substr(0, override.find('=')).find(':');
  return colon == std::string_view::npos ? std::string_view() : override.substr(0, colon);
}

std::vector<std::string> overrides_of(const std::vector<std::string>& all, std::string_view name) {
  std::vector<std::string> own;
  for (const std::string& override : all) {
    const std::string_view to = addressee(override);
    if (to.empty()) own.push_back(override);
    if (!to.empty() && to == name) own.push_back(override.substr(to.size() + 1));
  }
  return own;
}

Result<void> check_names(const RunSettings& settings, const std::vector<PlayedFile>& files) {
  std::set<std::string_view> names;
  for (const PlayedFile& file : files) {
    if (names.insert(file.name).second) continue;
    return fail(Errc::InvalidArgument, "two configurations are called '" + file.name +
                                           "', so that they cannot be told apart; rename one");
  }
  for (const std::string& override : settings.overrides) {
    const std::string_view to = addressee(override);
    if (to.empty() || names.contains(to)) continue;
    return fail(Errc::InvalidArgument,
                "--set " + override + ": no configuration is called '" + std::string(to) + "'");
  }
  return {};
}

tl::unexpected<Error> mistakes(const std::vector<config::ConfigError>& errors) {
  std::vector<std::string> lines;
  lines.reserve(errors.size());
  for (const config::ConfigError& error : errors) lines.push_back(to_string(error));
  return fail(Errc::InvalidArgument, in_one_line(lines));
}

// The text, too: so that who has the findings needs no file to play them again.
Result<void> load_into(PlayedFile& into, const std::string& file,
                       const std::vector<std::string>& overrides, session::Plugins& plugins) {
  auto text = config::read_text(file);
  if (!text) return mistakes(text.error());
  into.text = *std::move(text);
  auto config = config::parse(into.text, file, overrides, [&](const config::Config& said) {
    return session::inspect_with_plugins(said, plugins);
  });
  if (!config) return mistakes(config.error());
  into.config = *std::move(config);
  return {};
}

void add_to(sim::TraceHash& hash, const servo::ServoFrame& frame) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double number : {frame.tip[axis], frame.velocity[axis], frame.offset[axis],
                                frame.wish[axis], frame.force[axis]}) {
      hash.add(number);
    }
  }
  hash.add(frame.gain);
  hash.add(static_cast<std::uint8_t>(frame.state));
  hash.add(static_cast<std::uint8_t>(frame.fault));
}

}  // namespace

Result<std::unique_ptr<SessionRun>> SessionRun::load(const RunSettings& settings) {
  if (settings.files.empty()) return fail(Errc::InvalidArgument, "expected a configuration");
  std::unique_ptr<SessionRun> run(new SessionRun(settings));
  for (const std::string& file : settings.files) {
    run->files_.push_back({std::filesystem::path(file).stem().string()});
  }
  if (Result<void> good = check_names(settings, run->files_); !good) {
    return tl::unexpected(good.error());
  }
  for (std::size_t i = 0; i < settings.files.size(); ++i) {
    PlayedFile& file = run->files_[i];
    run->plugins_.push_back(std::make_unique<session::Plugins>());
    const Result<void> good =
        load_into(file, settings.files[i], overrides_of(settings.overrides, file.name),
                  *run->plugins_.back());
    if (!good) return tl::unexpected(good.error());
  }
  const std::vector<std::string> reasons = reasons_not_to_play(run->files_);
  if (!reasons.empty()) {
    return fail(Errc::Unsupported,
                in_one_line(settings.files, ", ") +
                    " cannot be played in virtual time: " + in_one_line(reasons));
  }
  const double rate_hz = servo_rate_hz(run->files_);
  for (PlayedFile& file : run->files_) file.config.servo.rate_hz = rate_hz;
  if (settings.seed) seed_all(run->files_, *settings.seed);
  auto session = VirtualSession::create(run->files_, run->plugins_);
  if (!session) return tl::unexpected(session.error());
  run->session_ = *std::move(session);
  run->traces_.resize(run->session_->arms());
  return run;
}

std::string SessionRun::name_of(std::size_t arm) const {
  const std::string& name = session_->arm(arm).session().config().name;
  return files_.size() > 1 ? files_[session_->file_of(arm)].name + ": " + name : name;
}

void SessionRun::play(const Progress& progress) {
  const double ticks = settings_.for_s / seconds(session_->period());
  const auto all = static_cast<std::uint64_t>(std::llround(ticks));
  shown_every_ = all / kMostRows + 1;
  for (std::uint64_t tick = 1; tick <= all; ++tick) {
    session_->tick();
    for (std::size_t i = 0; i < traces_.size(); ++i) note(i, tick % shown_every_ == 0);
    if (progress && (tick % kToldEvery == 0 || tick == all)) progress(tick, all);
  }
}

void SessionRun::note(std::size_t arm, bool is_shown) {
  ArmTrace& trace = traces_[arm];
  const servo::ServoFrame& frame = session_->arm(arm).session().snapshot().frame;
  add_to(trace.hash, frame);
  if (frame.gain > 0) trace.driven_s += seconds(session_->period());
  if (is_shown) trace.frames.push_back(frame);
}

}  // namespace thimble::lab
