#include "daemon/coupling/arm_pair.hpp"

#include <array>
#include <optional>
#include <utility>

#include "daemon/coupling/far_end_port.hpp"
#include "daemon/coupling/told_planes.hpp"

namespace thimble::coupling {
namespace {

bool is_sound_hand(const HandSample& sample) noexcept {
  const FarEnd far{.force = sample.pull,
                   .slave = sample.hand,
                   .velocity = sample.velocity,
                   .waves = sample.waves};
  return is_sound(far);
}

}  // namespace

struct ArmPair::Meeting {
  struct Hand {
    std::optional<HandSample> sample{};
    const Half* owner{nullptr};
  };
  std::array<Hand, 2> hands{};
  std::uint32_t next_session{1};
  std::uint32_t openings{0};
};

class ArmPair::Half final : public WorldCoupling {
 public:
  Half(std::shared_ptr<Meeting> meeting, std::size_t me, PeerAnswer kind)
      : meeting_(std::move(meeting)), me_(me), kind_(kind) {}
  ~Half() override { close(); }
  Half(const Half&) = delete;
  Half& operator=(const Half&) = delete;

  [[nodiscard]] Result<void> open(const HandSample& first) override {
    if (!is_sound_hand(first)) {
      return fail(Errc::InvalidArgument, "the hand's place or waves are not finite");
    }
    // Only TwoPortArm counts, and no arm tells it energies: its hand would not be let go on.
    if (first.energy_joule >= 0) {
      return fail(Errc::Unsupported,
                  "passivity = \"two-port\" needs a world that tells a force, not an arm");
    }
    meeting_->hands[me_] = {first, this};
    // An arm's own count may be that of another one, which was here before.
    restart_ = ++meeting_->openings;
    take(first);
    mine()->sequence = 0;  // the same sample may be answered, too
    begin();
    // What was said before is nothing new to an arm that starts again: the other may be gone.
    if (theirs()) heard_ = {theirs()->restart, theirs()->sequence};
    return {};
  }
  [[nodiscard]] ConstraintSet answer(const HandSample& sample, Duration dt) noexcept override {
    if (!is_mine() || !is_sound_hand(sample) || sample.sequence <= mine()->sequence) return last_;
    take(sample);
    if (!theirs() || theirs()->sequence == 0) return last_;
    const Heard newest{theirs()->restart, theirs()->sequence};
    if (newest == heard_) return last_;
    if (!has_met_ || newest.restart != heard_.restart) meet();
    heard_ = newest;
    ++last_.sequence;
    last_.answers = sample.sequence;
    last_.sampled_at = sample.sampled_at;
    if (kind_ == PeerAnswer::Motion) {
      tell_motion(sample);
    } else {
      tell_touch(sample.hand, dt);
    }
    return last_;
  }
  void close() noexcept override {
    if (is_mine()) meeting_->hands[me_] = {};
  }

 private:
  [[nodiscard]] bool is_mine() const noexcept { return meeting_->hands[me_].owner == this; }
  [[nodiscard]] std::optional<HandSample>& mine() noexcept { return meeting_->hands[me_].sample; }
  [[nodiscard]] const std::optional<HandSample>& theirs() const noexcept {
    return meeting_->hands[1 - me_].sample;
  }

  void take(const HandSample& sample) noexcept {
    mine() = sample;
    mine()->restart = restart_;
  }

  struct Heard {
    std::uint32_t restart{0};
    std::uint64_t sequence{0};
    bool operator==(const Heard&) const = default;
  };
  void begin() noexcept {
    has_met_ = false;
    heard_ = {};
    is_touching_ = false;
    stopped_ = {};
    last_ = {};
  }
  // From here on: nothing of an earlier session of theirs is told.
  void meet() noexcept {
    begin();
    has_met_ = true;
    before_ = theirs()->waves;
    last_.session = meeting_->next_session++;
  }

  void tell_motion(const HandSample& sample) noexcept {
    last_.has_far = true;
    last_.far.is_arm = true;
    last_.far.slave = theirs()->hand;
    last_.far.velocity = theirs()->velocity;
    last_.far.tool = theirs()->tool;
    last_.far.waves = theirs()->waves;
    last_.far.waves.distance -= before_.distance;
    for (std::size_t axis = 0; axis < 3; ++axis) last_.far.waves.joule[axis] -= before_.joule[axis];
    const Force3 pull = sample.tool.stiffness * (theirs()->hand - sample.hand);
    last_.far.is_pressing = norm(pull) > kTouch_newton;
  }

  void tell_touch(Position3 master, Duration dt) noexcept {
    const HandSample& slave = *theirs();
    const Force3 blocked = slave.pull - slave.tool.damping * slave.velocity;
    const double push_newton = norm(blocked);
    if (is_touching_) {
      const bool runs_on =
          dot(normal_, slave.velocity) > kStopped_m_per_s && dot(normal_, blocked) < kTouch_newton;
      running_on_ = runs_on ? running_on_ + dt : Duration{};
      is_touching_ = dot(normal_, master - slave.hand) >= 0 && running_on_ < kNoBounce;
    }
    const bool is_stopped = push_newton > kTouch_newton && norm(slave.velocity) < kStopped_m_per_s;
    stopped_ = is_stopped ? stopped_ + dt : Duration{};
    if (!is_touching_ && stopped_ >= kNoTurn) {
      is_touching_ = true;
      running_on_ = {};
      normal_ = {blocked.x / push_newton, blocked.y / push_newton, blocked.z / push_newton};
    }
    last_.ghost = slave.hand;
    last_.has_ghost = true;
    last_.planes.clear();
    if (!is_touching_) return;
    last_.planes.push_back({.normal = normal_,
                            .offset_m = dot(normal_, slave.hand - Position3{}),
                            .surface = {.stiffness = slave.tool.stiffness}});
  }

  std::shared_ptr<Meeting> meeting_;
  std::size_t me_;
  PeerAnswer kind_;
  std::uint32_t restart_{0};  // as the other one is told
  bool has_met_{false};
  Heard heard_{};
  WaveSums before_{};
  bool is_touching_{false};
  Direction3 normal_{};
  Duration running_on_{};
  Duration stopped_{};
  ConstraintSet last_{};
};

ArmPair::ArmPair(std::uint32_t first_session) : meeting_(std::make_shared<Meeting>()) {
  meeting_->next_session = first_session;
}

std::unique_ptr<WorldCoupling> ArmPair::make_half(Side side, PeerAnswer answer) const {
  return std::make_unique<Half>(meeting_, side == Side::First ? 0 : 1, answer);
}

}  // namespace thimble::coupling
