#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>

#include "daemon/coupling/arm_coupling.hpp"
#include "daemon/coupling/arm_pair.hpp"
#include "daemon/coupling/energy_observer.hpp"
#include "daemon/link/in_process_link.hpp"

namespace thimble::coupling::testing {

// One axis of an arm with a hand on it, 20 kHz below a servo of 1 kHz whose force arrives 1 ms
// late: what teleop.md 3 takes, and a wall where there is one. Without a hand: only the arm.
struct PairedArm {
  double mass_kg{0.15};
  double hand_newton_per_m{200};
  double hand_newton_s_per_m{4};
  double push_newton{0};  // of a hand that wishes a force and not a place
  double wall_m{std::numeric_limits<double>::infinity()};
  double wall_newton_per_m{20'000};

  double x_m{0};
  double v_m_per_s{0};
  double reference_m{0};
  double reference_m_per_s{0};
  double motor_newton{0};
  double from_wall_newton{0};
  EnergyObserver energy{};

  void advance(double commanded_newton) {
    constexpr double kDt_s = 1e-3 / 20;
    for (int i = 0; i < 20; ++i) {
      const double hand_newton = hand_newton_per_m * (reference_m - x_m) +
                                 hand_newton_s_per_m * (reference_m_per_s - v_m_per_s);
      const double depth_m = x_m - wall_m;
      from_wall_newton =
          depth_m > 0 ? -std::max(0.0, wall_newton_per_m * depth_m + 20 * v_m_per_s) : 0;
      const double before_m_per_s = v_m_per_s;
      v_m_per_s += kDt_s * (hand_newton + push_newton + motor_newton + from_wall_newton) / mass_kg;
      x_m += kDt_s * v_m_per_s;
      energy.add({motor_newton, 0, 0}, {(before_m_per_s + v_m_per_s) / 2, 0, 0},
                 from_seconds(kDt_s));
    }
    motor_newton = std::clamp(commanded_newton, -8.5, 8.5);
  }
};

// Two arms that are each other's far end, each on a link of its own.
class PairLoop {
 public:
  PairLoop(ArmCoupling& first, ArmCoupling& second, PeerAnswer for_first,
           const link::ImpairmentSettings& impairment)
      : couplings_{&first, &second} {
    const ArmPair pair(1);
    halves_[0] = pair.make_half(ArmPair::Side::First, for_first);
    halves_[1] = pair.make_half(ArmPair::Side::Second, PeerAnswer::Motion);
    for (std::size_t i = 0; i < 2; ++i) {
      link::ImpairmentSettings of_link = impairment;
      of_link.seed += i;
      links_[i].emplace(link::InProcessLink::Settings{.impairment = of_link}, *halves_[i]);
    }
  }

  void tick() {
    if (now_ == MonotonicTime{}) {
      for (std::size_t i = 0; i < 2; ++i) couplings_[i]->reset(now_, {arms[i].x_m, 0, 0});
    }
    run_links_until(now_ + kDt);
    now_ = now_ + kDt;
    for (std::size_t i = 0; i < 2; ++i) {
      if (!is_up[i]) {  // its program has ended: its arm is let go
        arms[i].advance(0);
        continue;
      }
      ConstraintSet reply;
      const bool is_fresh = links_[i]->arm_end().receive(reply);
      outputs[i] = couplings_[i]->step({.now = now_,
                                        .dt = kDt,
                                        .tip = {arms[i].x_m, 0, 0},
                                        .tip_velocity = {arms[i].v_m_per_s, 0, 0},
                                        .buttons = 0,
                                        .fresh = is_fresh ? &reply : nullptr,
                                        .link = links_[i]->arm_end().quality()});
      links_[i]->arm_end().send(outputs[i].sample);
      (void)links_[i]->pump(now_);
      arms[i].advance(outputs[i].force.x);
    }
  }

  std::array<PairedArm, 2> arms{};
  std::array<ArmOutput, 2> outputs{};
  std::array<bool, 2> is_up{true, true};

  static constexpr Duration kDt = std::chrono::milliseconds(1);

 private:
  void run_links_until(MonotonicTime end) {
    for (;;) {
      std::optional<MonotonicTime> due;
      std::size_t whose = 0;
      for (std::size_t i = 0; i < 2; ++i) {
        const auto of_link = dues_[i];
        if (!of_link || (due && *due <= *of_link)) continue;
        due = of_link;
        whose = i;
      }
      if (!due || *due > end) break;
      dues_[whose] = links_[whose]->pump(*due);
      if (dues_[whose] && *dues_[whose] <= *due) dues_[whose] = *due + Duration(1);
    }
    for (std::size_t i = 0; i < 2; ++i) dues_[i] = links_[i]->pump(end);
  }

  std::array<ArmCoupling*, 2> couplings_;
  std::array<std::unique_ptr<WorldCoupling>, 2> halves_;
  std::array<std::optional<link::InProcessLink>, 2> links_;
  std::array<std::optional<MonotonicTime>, 2> dues_{};
  MonotonicTime now_{};
};

}  // namespace thimble::coupling::testing
