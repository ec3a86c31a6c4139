#include "daemon/session/safety_session.hpp"

#include <algorithm>
#include <mutex>
#include <utility>

#include "daemon/session/safety_settings.hpp"

namespace thimble::session {

SafetySession::SafetySession(const config::SafetyConfig& safety, Runtime& runtime,
                             bus::GpioChips& chips, rt::WakeSignal* wake)
    : config_(safety),
      runtime_(runtime),
      chips_(chips),
      wake_(wake),
      chain_(make_chain_settings(safety)) {
  know_arms();
  publish();
}

SafetySession::~SafetySession() = default;

void SafetySession::step(const Clock& clock) {
  // A chip may take as long as it likes to open and to close: nobody who wants the arms waits for
  // it. Lost lines close when this returns: the stop is told before.
  const std::unique_ptr<bus::GpioLines> lost = take_lost_lines(clock.now());
  const bool are_new = open_lines(clock.now());
  const std::lock_guard guard(arms_lock_);
  const MonotonicTime now = clock.now();
  const bool was_unwatched = is_unwatched_.exchange(false);
  if (was_unwatched) chain_.stop(safety::ChainTrouble::Unwatched);
  if (are_new) chain_.restart_lines();
  stop_for_arms_out_of_reach(now);
  chain_.step(lines_.get(), now, [this] { return have_servos_beaten(); });
  // Who asked before what happened here knew nothing of it, and may have been refused long ago.
  answer_reset(!was_unwatched && !are_new && !is_late(now));
  stepped_at_ns_.store(std::max<std::int64_t>(now.since_epoch.count(), 1));
}

// Between the verdict and the answer: whoever reads the answer finds the servos told.
void SafetySession::answer_reset(bool may_be_free) {
  const std::uint32_t asked = reset_asked_.load();
  const bool is_new = asked != static_cast<std::uint32_t>(reset_answer_.load() / 2);
  const bool is_free = is_new && may_be_free && chain_.reset();
  publish();
  if (is_new) reset_answer_.store(std::uint64_t{asked} * 2 + (is_free ? 1 : 0));
}

std::unique_ptr<bus::GpioLines> SafetySession::take_lost_lines(MonotonicTime now) {
  bus::GpioLevels levels;
  if (lines_ == nullptr || lines_->levels(levels) != IoStatus::Disconnected) return nullptr;
  note_trouble(config_.chip + " was pulled out");
  next_try_ = now + kReopen;
  return std::move(lines_);
}

bool SafetySession::open_lines(MonotonicTime now) {
  if (lines_ != nullptr || now < next_try_) return false;
  next_try_ = now + kReopen;
  auto opened = chips_.open(make_gpio_claim(config_), wake_);
  note_trouble(opened ? std::string() : opened.error().message);
  if (!opened) return false;
  lines_ = *std::move(opened);
  return true;
}

void SafetySession::exchange_arms(const std::function<void()>& change) {
  const std::lock_guard guard(arms_lock_);
  change();
  know_arms();
  publish();
}

void SafetySession::leave_out(std::size_t arm) {
  const std::lock_guard guard(arms_lock_);
  if (arm < arms_.size()) arms_[arm].is_left_out = true;
}

bool SafetySession::have_servos_beaten() {
  bool have_all = true;
  for (Arm& arm : arms_) {
    servo::ServoSnapshot seen;
    if (arm.is_left_out) continue;
    if (!arm.rig->session().loop().snapshot(seen)) return false;
    if (seen.frame.tick == 0) continue;  // its servo is still to begin, and no force was ever
    have_all = have_all && seen.frame.tick != arm.ticks_seen;
    arm.ticks_seen = seen.frame.tick;
  }
  return have_all;
}

// Of whoever stayed nothing is forgotten.
void SafetySession::know_arms() {
  const std::vector<Arm> before = std::exchange(arms_, {});
  for (const auto& rig : runtime_.arms()) {
    servo::ServoSnapshot seen;
    const bool is_read = rig->session().loop().snapshot(seen);
    // One that came may lie where another went, but has ticked less.
    const auto is_same = [&](const Arm& arm) {
      return arm.rig == rig.get() && is_read && seen.frame.tick >= arm.ticks_seen;
    };
    const auto known = std::find_if(before.begin(), before.end(), is_same);
    arms_.push_back(known == before.end() ? Arm{.rig = rig.get()} : *known);
    arms_.back().is_left_out = false;
    const HapticCapabilities& can = rig->session().device().capabilities();
    arms_.back().ends_force_itself = !can.is_actuated || can.device_watchdog > Duration::zero();
  }
}

bool SafetySession::is_out_of_reach(Arm& arm, const servo::ServoSnapshot& seen,
                                    MonotonicTime now) noexcept {
  const bool is_wanted = seen.frame.state == OperatingState::Active;
  if (!seen.may_hold_force || is_wanted) {
    arm.holds_since.reset();
    arm.has_stopped = false;
    return false;
  }
  if (!arm.holds_since) arm.holds_since = now;
  return seen.frame.state == OperatingState::Lost || now - *arm.holds_since >= kDeaf;
}

void SafetySession::stop_for_arms_out_of_reach(MonotonicTime now) {
  if (!config_.enable) return;  // nothing that could be cut
  for (Arm& arm : arms_) {
    if (arm.ends_force_itself) continue;
    ArmSession& session = arm.rig->session();
    servo::ServoSnapshot seen;
    if (!session.loop().snapshot(seen)) continue;
    if (!is_out_of_reach(arm, seen, now) || std::exchange(arm.has_stopped, true)) continue;
    note_out_of_reach(session.config().name);
    chain_.hold(safety::ChainTrouble::ArmOutOfReach, now + kCut);
  }
}

void SafetySession::publish() {
  const safety::ChainStatus& status = chain_.status();
  const bool is_watched = !is_unwatched_.load();
  for (const auto& arm : runtime_.arms()) {
    servo::ServoControls& controls = arm->session().controls();
    controls.is_estop_healthy = !status.is_stopped && is_watched;
    controls.is_deadman_held = status.is_deadman_held && is_watched;
  }
  published_.store(status);
}

std::uint32_t SafetySession::ask_reset() {
  const std::uint32_t id = reset_asked_.fetch_add(1) + 1;
  if (wake_ != nullptr) wake_->signal();
  return id;
}

SafetySession::Answer SafetySession::answer() const noexcept {
  const std::uint64_t both = reset_answer_.load();
  return {static_cast<std::uint32_t>(both / 2), both % 2 != 0};
}

safety::ChainStatus SafetySession::status() const noexcept {
  safety::ChainStatus status;
  static_cast<void>(published_.load(status));
  if (status.is_stopped || !is_unwatched_.load()) return status;
  // What the thread of the lines will say once it runs again.
  status.is_stopped = true;
  status.trouble = safety::ChainTrouble::Unwatched;
  status.is_deadman_held = status.must_release_deadman = status.is_enable_beating = false;
  return status;
}

std::string SafetySession::trouble() const {
  const std::lock_guard guard(trouble_lock_);
  return trouble_;
}

void SafetySession::note_out_of_reach(const std::string& arm) {
  const std::lock_guard guard(trouble_lock_);
  out_of_reach_ = "arm '" + arm + "'";
}

void SafetySession::note_trouble(std::string text) {
  const std::lock_guard guard(trouble_lock_);
  trouble_ = std::move(text);
}

std::string SafetySession::explanation() const {
  const safety::ChainStatus now = status();
  std::string text = now.is_stopped ? explain_stop(now) : std::string();
  if (!now.must_release_deadman) return text;
  if (!text.empty()) text += "; ";
  text += kReleaseDeadman;
  return text;
}

std::string SafetySession::explain_stop(const safety::ChainStatus& now) const {
  if (now.awaits_first_clear()) return std::string(kNotYetCleared);
  const auto with_arm = [&](safety::ChainTrouble trouble, std::string_view text) {
    if (trouble != safety::ChainTrouble::ArmOutOfReach) return std::string(text);
    const std::lock_guard guard(trouble_lock_);
    return std::string(text) + " (" + out_of_reach_ + ")";
  };
  if (now.trouble == safety::ChainTrouble::ArmOutOfReach) {
    return with_arm(now.trouble, explain(now.trouble));
  }
  if (now.trouble == safety::ChainTrouble::None) {
    return "all safety lines are healthy again (the newest stop: " +
           with_arm(now.cause, recall(now.cause)) +
           "); clear the fault of each arm that shall go on";
  }
  const std::string detail = trouble();
  return std::string(explain(now.trouble)) + (detail.empty() ? "" : " (" + detail + ")");
}

bool SafetySession::is_late(MonotonicTime now) const noexcept {
  const std::int64_t stepped = stepped_at_ns_.load();
  return stepped != 0 && now.since_epoch.count() - stepped > kUnwatched.count();
}

void SafetySession::supervise(MonotonicTime now) noexcept {
  if (!is_late(now)) return;
  is_unwatched_.store(true);
  for (const auto& arm : runtime_.arms()) {
    arm->session().controls().is_estop_healthy = false;
    arm->session().controls().is_deadman_held = false;
  }
}

}  // namespace thimble::session
