#include "daemon/session/guarded_arm.hpp"

#include <utility>

namespace thimble::session {

Result<void> GuardedArm::begin(const HapticDevice& device) {
  if (bus::is_simulated(address_.text) || !devices::needs_guard(device.capabilities())) return {};
  const std::optional<ZeroCommand> zero = device.zero_command();
  if (!zero) {
    return fail(Errc::Unsupported,
                name_ + " needs a guard, but its driver does not say what takes its force away");
  }
  if (guards_ == nullptr) {
    return fail(Errc::Unsupported, name_ + " needs a guard, and this program has none");
  }
  zero_ = *zero;
  if (!guard_) {
    auto made = guards_->make();
    if (!made) return tl::unexpected(made.error().in(name_ + ": guard"));
    guard_ = *std::move(made);
  }
  return ask();
}

Result<void> GuardedArm::ask() {
  const Result<void> asked = guard_->ask(address_, zero_);
  is_asked_ = asked.has_value();
  asked_since_.reset();
  watching_since_.reset();
  controls_.is_guarded.store(is_asked_ && guard_->is_watching().value_or(false),
                             std::memory_order_relaxed);
  if (!asked) return tl::unexpected(asked.error().in(name_ + ": guard"));
  return {};
}

bool GuardedArm::is_overdue(MonotonicTime now) noexcept {
  if (!asked_since_) asked_since_ = now;
  return now - *asked_since_ >= kPatience;
}

Result<void> GuardedArm::follow(MonotonicTime now) {
  if (!guard_) return {};
  Result<bool> watching = guard_->is_watching();
  controls_.is_guarded.store(watching.value_or(false), std::memory_order_relaxed);
  if (watching.value_or(false)) {
    if (!watching_since_) watching_since_ = now;
    if (now - *watching_since_ >= kProven) pace_.ease();
    return {};
  }
  if (watching && !is_overdue(now)) return {};
  if (watching) watching = fail(Errc::Timeout, "it does not answer");
  // A person is told why before another one is asked.
  if (std::exchange(is_asked_, false)) {
    return tl::unexpected(watching.error().in(name_ + ": guard"));
  }
  if (!pace_.is_due(now)) return {};
  pace_.tried(now);
  return ask();
}

}  // namespace thimble::session
