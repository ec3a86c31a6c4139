#include "daemon/session/guarded_arm.hpp"

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
  return watch();
}

Result<void> GuardedArm::watch() {
  const Result<void> watched = guard_->watch(address_, zero_);
  controls_.is_guarded.store(watched.has_value(), std::memory_order_relaxed);
  if (!watched) return tl::unexpected(watched.error().in(name_ + ": guard"));
  pace_.ease();
  return {};
}

Result<void> GuardedArm::follow(MonotonicTime now) {
  if (!guard_ || guard_->is_watching()) return {};
  controls_.is_guarded.store(false, std::memory_order_relaxed);
  if (!pace_.is_due(now)) return {};
  pace_.tried(now);
  return watch();
}

}  // namespace thimble::session
