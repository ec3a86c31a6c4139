#include "daemon/coupling/far_end_port.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thimble::coupling {
namespace {

// No hand, force or wave that we know is as large, in any of their SI units; sums of an hour are
// not either.
constexpr double kAbsurd = 1e9;

template <class Vector>
bool is_sane(const Vector& v) noexcept {
  return std::abs(v.x) <= kAbsurd && std::abs(v.y) <= kAbsurd && std::abs(v.z) <= kAbsurd;
}

bool is_sane(const WaveSums& sums) noexcept {
  return is_sane(sums.distance) && std::all_of(sums.joule.begin(), sums.joule.end(),
                                               [](double e) { return e >= 0 && e <= kAbsurd; });
}

}  // namespace

bool is_sound(const FarEnd& far) noexcept {
  return is_sane(far.force) && is_sane(far.slave) && is_sane(far.velocity) && is_sane(far.waves);
}

void FarEndPort::reset(MonotonicTime now, Position3 tip) noexcept {
  ++restarts_;
  age_.restart(now);
  begin_epoch();
  applied_reply_ = 0;
  has_session_ = false;
  has_expired_ = false;
  was_pressing_ = false;
  if (is_finite(tip)) last_tip_ = tip;
}

void FarEndPort::begin_epoch() noexcept {
  is_new_epoch_ = true;
  onset_gain_ = 0;
}

const FarEnd* FarEndPort::listen(const ArmInput& input) noexcept {
  const bool is_usable =
      input.fresh != nullptr && input.fresh->has_far && is_sound(input.fresh->far);
  const ConstraintSet* const heard = hear(input, is_usable);
  return heard != nullptr ? &heard->far : nullptr;
}

const ConstraintSet* FarEndPort::hear(const ArmInput& input, bool is_usable) noexcept {
  ++sequence_;
  last_tip_ = input.tip;
  is_new_epoch_ = false;
  ArmInput heard = input;
  if (input.fresh != nullptr && !is_usable) {
    ++rejected_replies_;
    heard.fresh = nullptr;
  }
  age_.update(heard);
  if (age_.has_expired() && !has_expired_) {
    has_expired_ = true;
    has_session_ = false;
    ++restarts_;
    begin_epoch();
  }
  if (heard.fresh == nullptr) return nullptr;
  has_expired_ = false;
  if (!has_session_ || heard.fresh->session != session_) begin_epoch();
  has_session_ = true;
  session_ = heard.fresh->session;
  applied_reply_ = heard.fresh->sequence;
  return heard.fresh;
}

ArmOutput FarEndPort::show(const ArmInput& input, Force3 wish, bool is_pressing,
                           const ToolProperties& tool) noexcept {
  const double fade_s = seconds(fade_);
  if (has_session_)
    onset_gain_ = fade_s > 0 ? std::min(1.0, onset_gain_ + seconds(input.dt) / fade_s) : 1;

  ArmOutput output;
  output.force = gain() * wish;
  output.is_in_contact = is_pressing && gain() > 0;
  output.new_contacts = output.is_in_contact && !was_pressing_ ? 1 : 0;
  was_pressing_ = output.is_in_contact;
  output.is_frozen = age_.is_frozen();
  output.is_fading = age_.is_fading();
  output.sample = sample(input);
  output.sample.velocity = input.tip_velocity;
  output.sample.tool = tool;
  return output;
}

ArmOutput FarEndPort::refuse(const ArmInput& input) noexcept {
  constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
  ++sequence_;
  ArmOutput output;
  output.force = {kNotANumber, kNotANumber, kNotANumber};
  output.is_frozen = age_.is_frozen();
  output.is_fading = age_.is_fading();
  output.sample = sample(input);
  return output;
}

HandSample FarEndPort::sample(const ArmInput& input) const noexcept {
  HandSample sample;
  sample.sequence = sequence_;
  sample.sampled_at = input.now;
  sample.hand = last_tip_;
  sample.buttons = input.buttons;
  sample.applied_reply = applied_reply_;
  sample.restart = restarts_;
  return sample;
}

}  // namespace thimble::coupling
