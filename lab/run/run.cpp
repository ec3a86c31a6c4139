#include "lab/run/run.hpp"

#include <cmath>
#include <utility>

#include "daemon/config/load.hpp"
#include "daemon/session/inspect.hpp"
#include "lab/run/playable.hpp"

namespace thimble::lab {
namespace {

constexpr std::uint64_t kToldEvery = 1000;  // ticks

std::string in_one_line(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += (text.empty() ? "" : "; ") + line;
  return text;
}

void seed_all(config::Config& config, std::uint64_t seed) {
  for (config::ArmConfig& arm : config.arms) {
    if (arm.hand) arm.hand->seed = seed;
    if (arm.impairment) arm.impairment->seed = seed;
    ++seed;
  }
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
  std::unique_ptr<SessionRun> run(new SessionRun(settings));
  config::ConfigResult config =
      config::load(settings.file, settings.overrides, [&](const config::Config& said) {
        return session::inspect_with_plugins(said, run->plugins_);
      });
  if (!config) {
    std::vector<std::string> lines;
    for (const config::ConfigError& error : config.error()) lines.push_back(to_string(error));
    return fail(Errc::InvalidArgument, in_one_line(lines));
  }
  const std::vector<std::string> reasons = reasons_not_to_play(*config);
  if (!reasons.empty()) {
    return fail(Errc::Unsupported,
                settings.file + " cannot be played in virtual time: " + in_one_line(reasons));
  }
  if (settings.seed) seed_all(*config, *settings.seed);
  run->config_ = *std::move(config);
  auto session = VirtualSession::create(run->config_, run->plugins_);
  if (!session) return tl::unexpected(session.error());
  run->session_ = *std::move(session);
  run->traces_.resize(run->session_->arms());
  return run;
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
