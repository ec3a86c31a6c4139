// Two arms on two hosts: what one says reaches the other through our own datagrams.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "daemon/coupling/ghost_point_arm.hpp"
#include "daemon/coupling/spring_damper_arm.hpp"
#include "daemon/coupling/wave_arm.hpp"
#include "lab/trial/pair_loop.hpp"
#include "pair_loop.hpp"

namespace thimble::coupling {
namespace {

using testing::PairedArm;

// Whose far end is whose: what the host has, what the guest.
enum class Guests { SpringDamper, Wave, TouchOfTheGuest, TouchOfTheHost };

bool is_master(Guests guests, std::size_t arm) {
  return guests == (arm == 0 ? Guests::TouchOfTheHost : Guests::TouchOfTheGuest);
}

link::LinkKey key() {
  std::array<std::byte, link::LinkKey::kSize> bytes{};
  bytes.fill(std::byte{7});
  return link::LinkKey(bytes);
}

// `knows`: that the far end is an arm, as in one program; else it is told.
std::unique_ptr<ArmCoupling> make_half(Guests guests, std::size_t arm, bool knows) {
  if (guests == Guests::Wave) return std::make_unique<WaveArm>();
  if (is_master(guests, arm)) return std::make_unique<GhostPointArm>(GhostPointSettings{});
  SpringDamperSettings settings;
  settings.tool.stiffness = {400};
  settings.is_between_arms = knows;
  if (knows) settings.force_at = ForceAt::Both;
  return std::make_unique<SpringDamperArm>(settings);
}

class Pair {
 public:
  Pair(Guests guests, const link::ImpairmentSettings& network, bool is_on_two_hosts = true)
      : guests_(guests), knows_(!is_on_two_hosts), loop_(host(), second(network)) {}

  void tick() {
    std::array<lab::PairLoop::Seen, 2> seen{};
    for (std::size_t i = 0; i < 2; ++i) {
      seen[i] = {{arms[i].x_m, 0, 0}, {arms[i].v_m_per_s, 0, 0}};
    }
    out = loop_.tick(seen);
    now = now + testing::PairLoop::kDt;
    for (std::size_t i = 0; i < 2; ++i) arms[i].advance(loop_.is_up[i] ? out[i].force.x : 0);
    shift_m = std::max(shift_m, std::max(norm(out[0].offset), norm(out[1].offset)));
  }
  void run(double s) {
    for (int i = 0; i < static_cast<int>(s * 1000); ++i) tick();
  }
  void lead(std::size_t whose, double to_m) {
    PairedArm& hand = arms[whose];
    const double sign = to_m > hand.reference_m ? 1 : -1;
    hand.reference_m_per_s = sign * 0.1;
    while (sign * (to_m - hand.reference_m) > 0) {
      hand.reference_m += sign * 1e-4;
      tick();
    }
    hand.reference_m_per_s = 0;
  }
  void restart_guest() { loop_.restart_guest(make_half(guests_, 1, knows_), {arms[1].x_m, 0, 0}); }
  [[nodiscard]] lab::DatagramLink& link() { return *loop_.guest(); }
  [[nodiscard]] std::array<bool, 2>& is_up() { return loop_.is_up; }

  std::array<PairedArm, 2> arms{};
  std::array<ArmOutput, 2> out{};
  double shift_m{0};
  MonotonicTime now{};

 private:
  [[nodiscard]] lab::PairLoop::Arm host() const {
    return {make_half(guests_, 0, knows_), answer(0), {}, {}};
  }
  [[nodiscard]] lab::PairLoop::Arm second(const link::ImpairmentSettings& network) const {
    lab::PairLoop::Arm arm{make_half(guests_, 1, knows_), answer(1), network, {}};
    if (knows_) return arm;
    arm.guest.emplace();
    arm.guest->arm.key = key();
    arm.guest->world.key = key();
    return arm;
  }
  [[nodiscard]] PeerAnswer answer(std::size_t arm) const {
    return is_master(guests_, arm) ? PeerAnswer::Touch : PeerAnswer::Motion;
  }

  Guests guests_;
  bool knows_;
  lab::PairLoop loop_;
};

// An arm that nobody holds, with the friction of its own joints.
void leave_alone(PairedArm& arm) {
  arm.mass_kg = 0.1;
  arm.hand_newton_per_m = 0;
  arm.hand_newton_s_per_m = 0;
}

std::size_t leader_of(Guests guests) { return guests == Guests::TouchOfTheGuest ? 1 : 0; }

std::string name_of(const ::testing::TestParamInfo<Guests>& of) {
  constexpr std::array kNames{"SpringDamper", "Wave", "TouchOfTheGuest", "TouchOfTheHost"};
  return kNames.at(static_cast<std::size_t>(of.param));
}

class ArmGuest : public ::testing::TestWithParam<Guests> {};
INSTANTIATE_TEST_SUITE_P(, ArmGuest,
                         ::testing::Values(Guests::SpringDamper, Guests::Wave,
                                           Guests::TouchOfTheGuest, Guests::TouchOfTheHost),
                         name_of);

// Hands at rest until the session stands, then a lead, a wall, a way back.
std::vector<double> trace(Guests guests, double delay_s, bool is_on_two_hosts) {
  Pair sut(guests, {.delay_s = delay_s}, is_on_two_hosts);
  sut.arms[1 - leader_of(guests)].wall_m = 0.012;
  sut.run(1 + 4 * delay_s);
  std::vector<double> rows;
  const auto note = [&](int ticks) {
    for (int i = 0; i < ticks; ++i) {
      sut.tick();
      for (std::size_t arm = 0; arm < 2; ++arm) {
        rows.push_back(sut.out[arm].force.x);
        rows.push_back(sut.out[arm].offset.x);
        rows.push_back(sut.arms[arm].x_m);
      }
    }
  };
  for (const double to_m : {0.03, -0.01}) {
    sut.lead(leader_of(guests), to_m);
    note(700);
  }
  return rows;
}

TEST_P(ArmGuest, ItsTracesAreThoseOfOneProgramToTheBit) {
  for (const double delay_s : {0.0, 0.02, 0.1, 0.5}) {
    EXPECT_EQ(trace(GetParam(), delay_s, true), trace(GetParam(), delay_s, false)) << delay_s;
  }
}

TEST_P(ArmGuest, EachFeelsWhatTheOtherPressesAgainst) {
  const std::size_t leader = leader_of(GetParam());
  for (const double delay_s : {0.02, 0.2}) {
    Pair sut(GetParam(), {.delay_s = delay_s});
    leave_alone(sut.arms[1 - leader]);
    sut.arms[1 - leader].wall_m = 0.015;
    sut.run(0.5 + 3 * delay_s);
    sut.arms[leader].hand_newton_per_m = 0;
    sut.arms[leader].hand_newton_s_per_m = 20;
    sut.arms[leader].push_newton = 2;
    sut.run(6 + 80 * delay_s);
    const double felt_newton = -sut.out[leader].force.x;
    const double pressed_newton = -sut.arms[1 - leader].from_wall_newton;
    EXPECT_NEAR(felt_newton, 2, 0.02) << delay_s;
    const bool is_touch = GetParam() != Guests::Wave && GetParam() != Guests::SpringDamper;
    EXPECT_LT(felt_newton, (is_touch ? 1.55 : 1.05) * pressed_newton) << delay_s;
    EXPECT_GT(felt_newton, 0.95 * pressed_newton) << delay_s;
  }
}

TEST_P(ArmGuest, IsStillOnABadNetworkAndGivesNoEnergy) {
  const std::size_t leader = leader_of(GetParam());
  const bool is_touch = is_master(GetParam(), leader);
  for (const double delay_s : {0.02, 0.5}) {
    Pair sut(GetParam(), {.delay_s = delay_s,
                          .jitter_s = delay_s / 2,
                          .loss = 0.05,
                          .duplicate = 0.02,
                          .reorder = 0.05,
                          .seed = 7});
    if (is_touch) leave_alone(sut.arms[1 - leader]);
    sut.arms[1 - leader].wall_m = 0.01;
    sut.run(1 + 4 * delay_s);  // who is met far away is drawn near, which takes energy
    for (const double to_m : {0.04, 0.0, 0.03}) {
      sut.lead(leader, to_m);
      sut.run(3);
    }
    sut.run(10);
    double least_m = 1;
    double most_m = -1;
    double given_joule = 0;
    for (int i = 0; i < 2000; ++i) {
      sut.tick();
      least_m = std::min(least_m, sut.arms[leader].x_m);
      most_m = std::max(most_m, sut.arms[leader].x_m);
      const double slave_joule = is_touch ? 0 : sut.arms[1 - leader].energy.given_joule();
      given_joule = std::max(given_joule, sut.arms[leader].energy.given_joule() + slave_joule);
    }
    EXPECT_LT(most_m - least_m, 0.6e-3) << delay_s;
    EXPECT_LT(given_joule, 1e-3 + 25 * sut.shift_m * sut.shift_m) << delay_s;
    EXPECT_EQ(sut.link().status().counters.rejected(), 0U);
  }
}

// Whichever of the two falls silent, and also when it comes back as another program.
TEST_P(ArmGuest, TheOneWhosePeerIsSilentIsLetGoAndTakenUpWithoutAJump) {
  for (const std::size_t silent : {std::size_t{0}, std::size_t{1}}) {
    Pair sut(GetParam(), {.delay_s = 0.02});
    const std::size_t leader = leader_of(GetParam());
    leave_alone(sut.arms[1 - leader]);
    sut.arms[1 - leader].wall_m = 0.01;
    sut.run(1);
    sut.lead(leader, 0.03);
    sut.run(2);
    const std::size_t other = 1 - silent;
    ASSERT_GT(norm(sut.out[other].force), 0.3);
    double largest_newton = 0;
    const auto watch = [&](int ticks) {
      for (int i = 0; i < ticks; ++i) {
        const double before_newton = sut.out[other].force.x;
        sut.tick();
        largest_newton = std::max(largest_newton, std::abs(sut.out[other].force.x - before_newton));
      }
    };
    sut.is_up()[silent] = false;
    watch(600);
    EXPECT_EQ(sut.out[other].force, Force3{});
    EXPECT_TRUE(sut.out[other].is_fading);
    // A wall that a follower is thrown against would be a jump, too.
    sut.arms[1 - leader].wall_m = std::numeric_limits<double>::infinity();
    sut.arms[leader].reference_m = 0.01;
    watch(1000);
    sut.is_up()[silent] = true;
    if (silent == 1) sut.restart_guest();
    watch(3000);
    EXPECT_FALSE(sut.out[other].is_fading);
    EXPECT_LT(largest_newton, 1) << "teleop.md 5, G3: what the limiter takes";
    EXPECT_EQ(sut.link().world().sessions().size(), 1U);
  }
}

// It numbers its samples from the beginning, and its waves are those of another arm.
TEST_P(ArmGuest, AGuestThatRestartsAtOnceIsAnotherSessionAfterTheOldOnesSilence) {
  Pair sut(GetParam(), {.delay_s = 0.02});
  leave_alone(sut.arms[1 - leader_of(GetParam())]);
  sut.run(1);
  sut.lead(leader_of(GetParam()), 0.02);
  sut.run(1);
  sut.restart_guest();
  double largest_newton = 0;
  for (int i = 0; i < 4000; ++i) {
    const double before_newton = sut.out[0].force.x;
    sut.tick();
    largest_newton = std::max(largest_newton, std::abs(sut.out[0].force.x - before_newton));
  }
  EXPECT_LT(largest_newton, 1);
  EXPECT_EQ(sut.link().world().sessions().size(), 1U);
  EXPECT_GE(sut.link().world().total().rejected(link::RejectReason::SessionRefused), 1U)
      << "there is room for one";
  sut.lead(leader_of(GetParam()), 0.0);
  sut.run(3);
  if (GetParam() == Guests::Wave) return;  // a gap that was there stays
  EXPECT_NEAR(sut.arms[0].x_m, sut.arms[1].x_m, 0.5e-3);
}

// Noise, another key, and a capture played again change no bit of what the two feel.
TEST(ArmGuests, WhoHasNoKeyChangesNothing) {
  const auto felt = [](bool is_attacked) {
    Pair sut(Guests::Wave, {.delay_s = 0.02});
    std::vector<link::ThimbleDatagram> captured;
    sut.link().on_sent = [&](const auto& datagram) { captured.push_back(datagram); };
    std::mt19937 random(446);
    std::vector<double> rows;
    sut.run(1);
    sut.arms[0].reference_m = 0.02;
    for (int i = 0; i < 1000; ++i) {
      sut.tick();
      rows.push_back(sut.out[0].force.x);
      rows.push_back(sut.out[1].force.x);
      if (!is_attacked) continue;
      link::ThimbleDatagram datagram = captured[random() % captured.size()];
      sut.link().send_to_world(datagram.view(), sut.now);
      datagram.bytes[random() % datagram.size] ^= std::byte(1U << (random() % 8));
      sut.link().send_to_world(datagram.view(), sut.now);
    }
    return rows;
  };
  EXPECT_EQ(felt(true), felt(false));
}

// An arm at rest that hears `told` in the millisecond of its number.
ArmOutput hear(SpringDamperArm& arm, const ConstraintSet& told,
               std::chrono::milliseconds round_trip = std::chrono::milliseconds(1)) {
  return arm.step({.now = MonotonicTime{std::chrono::milliseconds(told.sequence)},
                   .dt = std::chrono::milliseconds(1),
                   .tip = {},
                   .tip_velocity = {},
                   .buttons = 0,
                   .fresh = &told,
                   .link = {true, round_trip, {}}});
}

// What a guest with the key says of itself, an arm takes with care.
TEST(ArmGuests, NoToolOfAPeerMakesASpringHarderOrDrivesIt) {
  std::mt19937_64 random(447);
  const std::array absurd{0.0,   -1.0,  -1e300, 1e-300,
                          1e300, 400.0, 5.0,    std::numeric_limits<double>::denorm_min()};
  SpringDamperArm sut({.tool = {{800}, {5}}});
  sut.reset({}, {});
  ConstraintSet told;
  told.has_far = true;
  for (int i = 0; i < 5000; ++i) {
    ++told.sequence;
    if (i % 500 == 0) ++told.session;
    told.far.is_arm = random() % 8 != 0;
    told.far.tool = {{absurd[random() % absurd.size()]}, {absurd[random() % absurd.size()]}};
    told.far.slave.x = 0.001 * static_cast<double>(random() % 10);
    const ArmOutput out = hear(sut, told, std::chrono::milliseconds(random() % 500));
    ASSERT_TRUE(is_finite(out.force));
    ASSERT_GE(sut.stiffness().newton_per_m, 0);
    ASSERT_LE(sut.stiffness().newton_per_m, 800);
    ASSERT_LE(std::abs(out.sample.pull.x), 7.21) << "800 N/m at 9 mm";
  }
}

// One that says it is an arm, and is none in the next answer, changes no law under the hand.
TEST(ArmGuests, WhatAForceIsMadeOfStaysForASession) {
  for (const bool begins_as_arm : {false, true}) {
    SpringDamperArm sut({.tool = {{800}, {5}}});
    sut.reset({}, {});
    ConstraintSet told;
    told.has_far = true;
    told.session = 1;
    told.far.tool = {{800}, {5}};
    told.far.slave.x = 0.01;
    Force3 last{};
    for (int i = 0; i < 1000; ++i) {
      ++told.sequence;
      told.far.is_arm = begins_as_arm == (i % 2 == 0);
      const ArmOutput out = hear(sut, told);
      ASSERT_LT(std::abs(out.force.x - last.x), 0.2) << "8 N come in 100 ms";
      last = out.force;
    }
    EXPECT_NEAR(last.x, begins_as_arm ? 8 : 0, 1e-9);
  }
}

// K_c is held for the peer that is there, not for the one before.
TEST(ArmGuests, ASoftPeerSoftensNobodyAfterwards) {
  SpringDamperArm sut({.tool = {{800}, {5}}});
  sut.reset({}, {});
  ConstraintSet told;
  told.has_far = true;
  told.far.is_arm = true;
  const auto stiffness_after = [&](std::uint32_t session, double theirs) {
    ++told.sequence;
    told.session = session;
    told.far.tool = {{theirs}, {5}};
    (void)hear(sut, told);
    return sut.stiffness().newton_per_m;
  };
  EXPECT_EQ(stiffness_after(1, 100), 100);
  EXPECT_EQ(stiffness_after(1, 500), 100) << "it only falls";
  EXPECT_EQ(stiffness_after(2, 500), 500);
}

}  // namespace
}  // namespace thimble::coupling
