#include "daemon/safety/safety_chain.hpp"

#include <algorithm>
#include <array>
#include <span>

namespace thimble::safety {

SafetyChain::SafetyChain(const ChainSettings& settings) noexcept
    : settings_(settings), reader_(settings.inputs()), channels_(settings.estop_channels) {}

void SafetyChain::restart_lines() noexcept {
  reader_.restart();
  deadman_.distrust();
  stuck_since_.reset();
  is_enable_high_ = false;
  is_beat_taken_ = true;
}

bool SafetyChain::reset() noexcept {
  const bool is_free = latch_.reset();
  status_.is_stopped = !is_free;
  return is_free;
}

void SafetyChain::stop(ChainTrouble cause) noexcept {
  if (!latch_.is_stopped()) {
    ++status_.stops;
    status_.cause = cause;
    deadman_.distrust();
    status_.is_deadman_held = status_.is_deadman_held && !settings_.has_deadman;
  }
  latch_.judge(false);
  status_.is_stopped = true;
  status_.is_enable_beating = false;
}

void SafetyChain::hold(ChainTrouble cause, MonotonicTime until) noexcept {
  held_for_ = cause;
  held_until_ = std::max(held_until_, until);
  stop(cause);
}

void SafetyChain::judge(bus::GpioLines* lines, MonotonicTime now) noexcept {
  status_.trouble = find_trouble(lines, now);
  if (status_.trouble != ChainTrouble::None) {
    stop(status_.trouble);
  } else {
    latch_.judge(true);
  }
  const bool is_beat_fresh = now - last_beat_ <= 3 * kEnableHalfPeriod;
  status_.is_enable_beating = status_.beats > 0 && !status_.is_stopped && is_beat_fresh;
}

ChainTrouble SafetyChain::find_trouble(bus::GpioLines* lines, MonotonicTime now) noexcept {
  status_.is_deadman_held = status_.must_release_deadman = false;
  const ChainTrouble of_reading =
      lines == nullptr ? ChainTrouble::NoLines : reader_.step(*lines, now);
  if (of_reading == ChainTrouble::NoLines || of_reading == ChainTrouble::Silent) {
    deadman_.distrust();
    return of_reading;
  }
  judge_channels();
  judge_deadman();
  look_at_enable(*lines, now);
  const Duration patience = settings_.has_enable ? kEnableGap : kSilence;
  if (stuck_since_ && now - *stuck_since_ > patience) return ChainTrouble::OutputStuck;
  if (of_reading != ChainTrouble::None) return of_reading;
  if (channels_.is_open()) return ChainTrouble::Open;
  if (channels_.has_disagreed()) return ChainTrouble::Disagree;
  if (now < held_until_) return held_for_;
  if (!has_enable_paused(now)) return ChainTrouble::None;
  return stuck_since_ ? ChainTrouble::OutputStuck : ChainTrouble::EnablePaused;
}

void SafetyChain::look_at_enable(bus::GpioLines& lines, MonotonicTime now) noexcept {
  if (!settings_.has_enable || is_beat_taken_) return;
  is_beat_taken_ = put(lines, 0, is_enable_high_, now);
  if (is_beat_taken_ && is_enable_high_ && charged_at_) charged_at_ = untaken_at_;
  untaken_at_ = now;
}

bool SafetyChain::has_enable_paused(MonotonicTime now) noexcept {
  if (!settings_.has_enable || latch_.is_stopped()) {
    charged_at_.reset();
    return false;
  }
  if (!charged_at_) charged_at_ = now;  // the latch was let go just now
  return now - *charged_at_ > kEnableGap;
}

void SafetyChain::judge_channels() noexcept {
  std::array<bool, kMaxEstopChannels> is_closed{};
  std::array<bool, kMaxEstopChannels> is_read_closed{};
  for (std::size_t i = 0; i < settings_.estop_channels; ++i) {
    is_closed.at(i) = reader_.was_always(i, settings_.is_closed_high);
    is_read_closed.at(i) = reader_.levels().is_high(i) == settings_.is_closed_high;
  }
  channels_.step(is_closed);
  channels_.compare(is_read_closed, reader_.levels().read_at);
}

void SafetyChain::judge_deadman() noexcept {
  if (!settings_.has_deadman) {
    status_.is_deadman_held = true;
    return;
  }
  const std::size_t line = settings_.estop_channels;
  const bool is_read_open = reader_.levels().is_high(line) != settings_.is_closed_high;
  deadman_.see(is_read_open, reader_.levels().read_at);
  const bool is_closed = reader_.was_always(line, settings_.is_closed_high);
  status_.is_deadman_held = is_closed && deadman_.is_trusted();
  status_.must_release_deadman = is_closed && !deadman_.is_trusted();
}

bool SafetyChain::is_beat_due(MonotonicTime now) const noexcept {
  return now >= next_beat_ && is_beat_taken_;
}

void SafetyChain::beat(bus::GpioLines* lines, MonotonicTime now, bool have_servos_beaten) noexcept {
  next_beat_ = now + kEnableHalfPeriod;
  if (settings_.has_lamp) put(*lines, settings_.has_enable ? 1 : 0, true, now);
  if (!settings_.has_enable || !have_servos_beaten) return;
  is_enable_high_ = !is_enable_high_;
  is_beat_taken_ = false;
  untaken_at_ = now;
  put(*lines, 0, is_enable_high_, now);
  ++status_.beats;
  last_beat_ = now;
}

// Low says nothing to the hardware that a beat that stops did not; it only looks tidy on a meter.
void SafetyChain::rest(bus::GpioLines* lines, MonotonicTime now) noexcept {
  if (lines == nullptr || now < next_beat_) return;
  next_beat_ = now + kEnableHalfPeriod;
  is_enable_high_ = false;
  is_beat_taken_ = true;  // nothing waits for this one
  if (settings_.has_enable) put(*lines, 0, false, now);
  if (!settings_.has_lamp) return;
  const bool is_awaited = status_.trouble == ChainTrouble::None;
  const bool is_lit = is_awaited && (now.since_epoch / kLampHalfPeriod) % 2 == 0;
  put(*lines, settings_.has_enable ? 1 : 0, is_lit, now);
}

bool SafetyChain::put(bus::GpioLines& lines, std::size_t output, bool is_high,
                      MonotonicTime now) noexcept {
  const IoStatus status = lines.set(output, is_high);
  if (status == IoStatus::Ok) stuck_since_.reset();
  if (status == IoStatus::Backlogged && !stuck_since_) stuck_since_ = now;
  return status == IoStatus::Ok;
}

}  // namespace thimble::safety
