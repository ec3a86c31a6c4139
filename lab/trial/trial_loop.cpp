#include "lab/trial/trial_loop.hpp"

#include <array>
#include <cstddef>
#include <utility>

#include "daemon/link/thimble_codec.hpp"

namespace thimble::lab {
namespace {

constexpr std::size_t kOpenSamples = 4096;  // longer than any round trip of the lab

// Of our own datagram, in the clear; what cannot be said in it has none.
template <class Message>
std::uint64_t size_of(const Message& message) {
  std::array<std::byte, link::kMaxThimbleContent> content{};
  const auto size = link::encode(message, content);
  return size ? link::kThimbleHeaderSize + *size : 0;
}

}  // namespace

TrialLoop::TrialLoop(std::unique_ptr<coupling::ArmCoupling> arm_half,
                     std::unique_ptr<coupling::WorldCoupling> world_half, const Settings& settings)
    : settings_(settings),
      arm_half_(std::move(arm_half)),
      world_half_(std::move(world_half)),
      link_({.mode = settings.mode, .impairment = settings.impairment}, *world_half_),
      deadband_(settings.mode == link::SendMode::Streamed ? settings.deadband_m : 0),
      told_(kOpenSamples) {}

coupling::ArmOutput TrialLoop::tick(Position3 tip, Velocity3 velocity) {
  if (std::exchange(is_first_, false)) arm_half_->reset(now_, tip);
  const MonotonicTime end = now_ + settings_.dt;
  std::optional<MonotonicTime> due = link_.pump(now_);
  while (due && *due <= end) due = link_.pump(*due);
  now_ = end;
  coupling::ConstraintSet reply;
  const bool is_fresh = link_.arm_end().receive(reply) && is_up_;
  if (is_fresh) note_answer(reply);
  const coupling::ArmOutput output = arm_half_->step({.now = now_,
                                                      .dt = settings_.dt,
                                                      .tip = tip,
                                                      .tip_velocity = velocity,
                                                      .buttons = 0,
                                                      .fresh = is_fresh ? &reply : nullptr,
                                                      .link = link_.arm_end().quality()});
  const std::uint64_t sent_before = link_.status().counters.sent;
  send(output.sample);
  link_.pump(now_);
  // In lock-step only what was asked for leaves.
  const std::uint64_t sent = link_.status().counters.sent - sent_before;
  if (sent > 0) bytes_ += sent * size_of(link::ThimbleSample{.sample = output.sample});
  return output;
}

// As ThimbleArmEnd does; nobody knows that a network is down.
void TrialLoop::send(const coupling::HandSample& sample) {
  const coupling::LinkQuality quality = link_.arm_end().quality();
  if (deadband_.may_skip(sample, now_, quality.round_trip + 4 * quality.jitter)) {
    ++samples_withheld_;
    return;
  }
  deadband_.on_sent(sample, now_);
  told_[sample.sequence % told_.size()] = {sample.sequence, sample.hand, now_};
  if (!is_up_) return;
  link_.arm_end().send(sample);
  ++samples_sent_;
}

void TrialLoop::note_answer(const coupling::ConstraintSet& reply) noexcept {
  bytes_ += size_of(link::ThimbleConstraints{.request = reply.answers, .set = reply});
  const Told& told = told_[reply.answers % told_.size()];
  if (told.sequence == reply.answers) deadband_.on_answered(told.hand, told.sent_at);
}

}  // namespace thimble::lab
