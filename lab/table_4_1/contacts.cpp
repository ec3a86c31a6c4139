#include "lab/table_4_1/contacts.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "daemon/world/io/world_source.hpp"
#include "lab/trial/finger.hpp"
#include "lab/trial/random.hpp"

namespace thimble::lab {
namespace {

// SOURCE of all: teleop.md section 4.
constexpr const char* kWorld = "box:3";  // cells of 30 mm, the middle one free
constexpr double kWall_m = 0.015;
constexpr double kReach_m = 0.0635;
constexpr double kFelt_newton = 0.5;
constexpr double kRelaxed_m = 0.002;
constexpr double kSweep_m = 0.045;

// Ours: a contact takes some 3 s at most (500 ms of delay, 48 mm of offset that return at 25 mm/s).
constexpr double kMostTimeAContact_s = 4;
// Ours: of one touch, teleop.md section 8 ("re-detections within 50 ms = chatter").
constexpr double kOneTouch_s = 0.05;

double length_m(Displacement3 v) { return norm(v.x, v.y, v.z); }

// What was felt when, of either hand.
class Felt {
 public:
  explicit Felt(ContactStatistics& statistics) : statistics_(statistics) {}

  // After each tick; `out_m`: the tip's way along the axis towards the wall. True: a touch began.
  bool note(const coupling::ArmOutput& output, double towards, std::size_t axis, Position3 tip,
            double now_s) {
    const Displacement3 before = std::exchange(offset_, output.offset);
    if (!output.is_in_contact) return false;
    const bool is_new = now_s - last_s_ > kOneTouch_s;
    last_s_ = now_s;
    if (!is_new) return false;
    statistics_.offset_m.add(length_m(output.offset));
    statistics_.change_m.add(length_m(output.offset - before));
    statistics_.penetration_m.add(towards * (tip + before)[axis] - kWall_m);
    return true;
  }

 private:
  ContactStatistics& statistics_;
  Displacement3 offset_{};
  double last_s_{-1};
};

// H1: from the middle of what is felt to a random face, and back when that is felt; on when the
// frame has returned.
class KinematicHand {
 public:
  KinematicHand(double speed_m_per_s, double most_wait_s, std::uint64_t seed)
      : speed_m_per_s_(speed_m_per_s), most_wait_s_(most_wait_s), random_(seed) {
    plan();
  }

  void advance(double dt_s, const coupling::ArmOutput& felt) {
    const double before_m = out_m_;
    if (stage_ == Stage::Wait) wait(dt_s, felt);
    if (stage_ == Stage::Approach) approach(dt_s, felt);
    if (stage_ == Stage::Retreat) retreat(dt_s, felt);
    velocity_m_per_s_ = (out_m_ - before_m) / dt_s;
  }

  [[nodiscard]] Position3 tip() const {
    Position3 tip;
    tip[axis_] = towards_ * out_m_;
    return tip;
  }
  [[nodiscard]] Velocity3 velocity() const {
    Velocity3 velocity;
    velocity[axis_] = towards_ * velocity_m_per_s_;
    return velocity;
  }
  [[nodiscard]] bool is_at_end() const { return out_m_ >= kReach_m; }
  [[nodiscard]] std::size_t axis() const { return axis_; }
  [[nodiscard]] double towards() const { return towards_; }

 private:
  enum class Stage { Wait, Approach, Retreat };

  // Waits of any length up to two round trips, and starts within a tick's way: every phase of
  // lock-step and of the servo comes up.
  void plan() {
    axis_ = static_cast<std::size_t>(random_.next() % 3);
    towards_ = random_.next() % 2 == 0 ? 1 : -1;
    wait_s_ = random_.uniform(0, most_wait_s_);
    start_m_ = random_.uniform(0, 1e-3 * speed_m_per_s_);
  }
  void wait(double dt_s, const coupling::ArmOutput& felt) {
    const double middle_m = -towards_ * felt.offset[axis_];
    if (length_m(felt.offset) > kRelaxed_m) {
      out_m_ = middle_m;
      return;
    }
    if (has_planned_) {
      wait_s_ -= dt_s;
    } else {
      plan();
      has_planned_ = true;
      out_m_ = 0;
    }
    if (wait_s_ > 0) return;
    stage_ = Stage::Approach;
    out_m_ = start_m_;
  }
  void approach(double dt_s, const coupling::ArmOutput& felt) {
    const double push_newton = -towards_ * felt.force[axis_];
    if (push_newton > kFelt_newton || (is_at_end() && felt.is_in_contact)) {
      stage_ = Stage::Retreat;
    } else {
      out_m_ = std::min(out_m_ + dt_s * speed_m_per_s_, kReach_m);
    }
  }
  void retreat(double dt_s, const coupling::ArmOutput& felt) {
    const double middle_m = -towards_ * felt.offset[axis_];
    out_m_ = std::max(out_m_ - dt_s * speed_m_per_s_, middle_m);
    if (out_m_ > middle_m) return;
    stage_ = Stage::Wait;
    has_planned_ = false;
  }

  double speed_m_per_s_;
  double most_wait_s_;
  Random random_;
  Stage stage_{Stage::Wait};
  bool has_planned_{true};
  std::size_t axis_{0};
  double towards_{1};
  double out_m_{0};
  double velocity_m_per_s_{0};
  double wait_s_{0};
  double start_m_{0};
};

std::uint64_t most_ticks(const ContactRun& of, double dt_s) {
  return static_cast<std::uint64_t>(static_cast<double>(of.contacts) * kMostTimeAContact_s / dt_s);
}

ContactStatistics run_kinematic(const ContactRun& of, TrialLoop& loop) {
  const double dt_s = seconds(loop.dt());
  ContactStatistics statistics;
  Felt felt(statistics);
  KinematicHand hand(of.speed_m_per_s, 2 * of.impairment.delay_s + dt_s, of.seed);
  coupling::ArmOutput output;
  const std::uint64_t end = most_ticks(of, dt_s);
  for (std::uint64_t tick = 0; tick < end && statistics.offset_m.count() < of.contacts; ++tick) {
    hand.advance(dt_s, output);
    output = loop.tick(hand.tip(), hand.velocity());
    const bool is_new = felt.note(output, hand.towards(), hand.axis(), hand.tip(),
                                  static_cast<double>(tick) * dt_s);
    if (is_new && hand.is_at_end()) ++statistics.at_end;
  }
  return statistics;
}

// H2: to and fro through the box along x.
ContactStatistics run_dynamic(const ContactRun& of, TrialLoop& loop) {
  const double dt_s = seconds(loop.dt());
  ContactStatistics statistics;
  Felt felt(statistics);
  Finger finger({}, loop.dt());
  coupling::ArmOutput output;
  FingerGoal goal;
  double speed_m_per_s = of.speed_m_per_s;
  double last_at_m = 0;
  Spread travel;
  const std::uint64_t end = most_ticks(of, dt_s);
  for (std::uint64_t tick = 0; tick < end && statistics.offset_m.count() < of.contacts; ++tick) {
    goal.at.x += dt_s * speed_m_per_s;
    if (std::abs(goal.at.x) >= kSweep_m)
      speed_m_per_s = -std::copysign(of.speed_m_per_s, goal.at.x);
    goal.moving.x = speed_m_per_s;
    finger.move(goal, output.force);
    output = loop.tick(finger.tip(), finger.seen_velocity());
    const double x_m = finger.tip().x;
    const double now_s = static_cast<double>(tick) * dt_s;
    if (!felt.note(output, std::copysign(1.0, x_m), 0, finger.tip(), now_s)) continue;
    if (last_at_m * x_m < 0) travel.add(std::abs(x_m - last_at_m));
    last_at_m = x_m;
  }
  statistics.travel_m = travel.mean();
  return statistics;
}

}  // namespace

Result<ContactStatistics> run_contacts(const ContactRun& of) {
  const auto world = world::make_world(kWorld);
  if (!world) return tl::unexpected(world.error());
  CouplingCase as{.name = "ghost-point", .settings = of.settings, .mode = of.mode};
  as.settings.ghost_point.cell_m = (*world)->info().cell_m;
  auto loop = make_trial(as, **world, {.impairment = of.impairment});
  if (!loop) return tl::unexpected(loop.error());
  return of.hand == HandKind::Kinematic ? run_kinematic(of, **loop) : run_dynamic(of, **loop);
}

std::vector<Parameter> contact_parameters() {
  return {{"world", "", std::string(kWorld)},
          {"wall", "m", kWall_m},
          {"reach", "m", kReach_m},
          {"felt_from", "N", kFelt_newton},
          {"relaxed_below", "m", kRelaxed_m},
          {"finger_sweep", "m", kSweep_m},
          {"one_touch_within", "s", kOneTouch_s}};
}

}  // namespace thimble::lab
