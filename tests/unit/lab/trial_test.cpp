#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "daemon/world/io/world_source.hpp"
#include "lab/trial/coupling_case.hpp"
#include "lab/trial/declared_energy.hpp"
#include "lab/trial/finger.hpp"
#include "lab/trial/parallel.hpp"
#include "lab/trial/parameters.hpp"
#include "lab/trial/random.hpp"
#include "lab/trial/spread.hpp"

namespace thimble::lab {
namespace {

constexpr Duration kTick = std::chrono::milliseconds(1);

TEST(Finger, RestsWhereItsSpringAndAForceAreInBalance) {
  Finger finger({}, kTick, {.friction_newton = 0});
  const FingerGoal goal{.at = {0.01, 0, -0.02}};
  for (int i = 0; i < 3000; ++i) finger.move(goal, {-1, 0, 2});
  EXPECT_NEAR(finger.tip().x, 0.01 - 1.0 / 200, 1e-6);
  EXPECT_NEAR(finger.tip().y, 0, 1e-9);
  EXPECT_NEAR(finger.tip().z, -0.02 + 2.0 / 200, 1e-6);
}

TEST(Finger, SwingsAsTheTextbookHasIt) {
  // Undriven, from rest at 10 mm: x = a·e^(−ζωt)·(cos ω_d·t + ζω/ω_d·sin ω_d·t).
  Finger finger({0.01, 0, 0}, kTick, {.friction_newton = 0});
  const double omega = std::sqrt(200 / 0.15);
  const double decay = 4 / (2 * 0.15);
  const double damped = std::sqrt(omega * omega - decay * decay);
  for (int i = 1; i <= 400; ++i) {
    finger.move({}, {});
    const double t = 1e-3 * i;
    const double expected = 0.01 * std::exp(-decay * t) *
                            (std::cos(damped * t) + decay / damped * std::sin(damped * t));
    ASSERT_NEAR(finger.tip().x, expected, 2e-5) << i << " ms";
  }
}

TEST(Finger, StopsAtTheEndOfTheReachAndGivesNoMoreThanTheArmCan) {
  Finger finger({}, kTick);
  for (int i = 0; i < 2000; ++i) finger.move({.at = {1, 0, 0}}, {-100, 0, 0});
  EXPECT_DOUBLE_EQ(finger.tip().x, 0.0635);
  // 8.5 N, not 100: the spring pulls with 200 N/m over 936 mm.
  EXPECT_NEAR(finger.energy().given_joule(), -8.5 * 0.0635, 1e-9);
}

TEST(Finger, APushedOneIsMovedByItsPush) {
  Finger finger({}, kTick, {.friction_newton = 0});
  for (int i = 0; i < 3000; ++i) {
    finger.move({.push_newton = 2, .is_pushing = true}, {-800 * finger.tip().x, 0, 0});
  }
  EXPECT_NEAR(finger.tip().x, 2.0 / 800, 1e-6);
}

TEST(TrialLoop, ASampleIsAnsweredAfterTheDelayAndNoSooner) {
  for (const int delay_ms : {1, 7, 50}) {
    const auto world = world::make_world("box:3");
    ASSERT_TRUE(world);
    const link::ImpairmentSettings impairment{.delay_s = 1e-3 * delay_ms};
    auto loop = make_trial({.name = "ghost-point"}, **world, {.impairment = impairment});
    ASSERT_TRUE(loop) << loop.error().message;
    // In the wall from the first tick on: the first sample opens the session there.
    int felt_at_ms = 0;
    for (int tick = 1; tick <= 200 && felt_at_ms == 0; ++tick) {
      const Position3 tip{tick < 100 ? 0.0 : 0.016, 0, 0};
      if ((*loop)->tick(tip, {}).is_in_contact) felt_at_ms = tick;
    }
    EXPECT_EQ(felt_at_ms, 100 + delay_ms);
  }
}

double most_given_joule(Guard guard) {
  const auto world = world::make_world("box:3");
  auto loop =
      make_trial({.name = "remote-force", .scheme = coupling::Scheme::RemoteForce, .guard = guard},
                 **world, {.impairment = {.delay_s = 0.05}});
  EXPECT_TRUE(loop);
  Finger finger({}, (*loop)->dt());
  for (int tick = 0; tick < 2000; ++tick) {
    const coupling::ArmOutput out = (*loop)->tick(finger.tip(), finger.seen_velocity());
    finger.move({.at = {0.02, 0, 0}}, out.force);
  }
  return finger.energy().generated_joule();
}

// A remote force at 50 ms swings, and what a guard adds is against it.
TEST(TrialLoop, AGuardedSchemeGivesTheHandLess) {
  const double bare = most_given_joule(Guard::None);
  EXPECT_LT(most_given_joule(Guard::AtHand), 0.8 * bare);
  EXPECT_LT(most_given_joule(Guard::BothEnds), 0.1 * bare);
}

TEST(TrialLoop, AGuardAtBothEndsNeedsAForceThatTheWorldTells) {
  const auto world = world::make_world("box:3");
  for (const coupling::Scheme scheme : coupling::kSchemes) {
    CouplingCase of{.name = "guarded", .scheme = scheme, .guard = Guard::BothEnds};
    const bool is_told =
        scheme == coupling::Scheme::RemoteForce || scheme == coupling::Scheme::SpringDamper;
    EXPECT_EQ(can_have(Guard::BothEnds, of), is_told) << to_string(scheme);
    EXPECT_TRUE(can_have(Guard::AtHand, of));
    const auto loop = make_trial(of, **world, {});
    EXPECT_EQ(loop.has_value(), is_told);
    if (!loop) {
      EXPECT_EQ(loop.error().code, Errc::InvalidArgument);
    }
    of.world_half.force_at = coupling::ForceAt::Both;
    EXPECT_EQ(can_have(Guard::BothEnds, of), scheme == coupling::Scheme::RemoteForce);
  }
}

TEST(TrialLoop, ANetworkThatIsDownCarriesNothingEitherWay) {
  const auto world = world::make_world("box:3");
  ASSERT_TRUE(world);
  auto loop = make_trial({.name = "ghost-point"}, **world, {});
  ASSERT_TRUE(loop);
  (void)(*loop)->tick({}, {});
  (*loop)->set_network(false);
  const std::uint64_t sent = (*loop)->samples_sent();
  for (int i = 0; i < 100; ++i) EXPECT_FALSE((*loop)->tick({0.02, 0, 0}, {}).is_in_contact);
  EXPECT_EQ((*loop)->samples_sent(), sent);
  (*loop)->set_network(true);
  bool is_felt = false;
  for (int i = 0; i < 5; ++i) is_felt |= (*loop)->tick({0.02, 0, 0}, {}).is_in_contact;
  EXPECT_TRUE(is_felt);
}

std::map<std::string, Cell> listed(const std::vector<Parameter>& all) {
  std::map<std::string, Cell> by_name;
  for (const Parameter& one : all) {
    EXPECT_TRUE(by_name.emplace(one.name, one.value).second) << one.name << " is there twice";
  }
  return by_name;
}

// Whoever reads a file of findings later has no other place to look.
TEST(Parameters, AreThoseOfEachCaseAndSayWhatWasChanged) {
  using coupling::Scheme;
  CouplingCase zone{.name = "zone", .scheme = Scheme::BufferZone};
  zone.world_half.buffer_zone = {.buffer_m = 0.012, .names = coupling::ZoneNames::Faces};
  CouplingCase wave{.name = "wave", .scheme = Scheme::Wave, .guard = Guard::AtHand};
  wave.settings.wave.impedance = {7};
  const CouplingCase band{.name = "ghost", .mode = link::SendMode::LockStep, .deadband_m = 0.0005};
  const auto all = listed(parameters_of(std::vector<CouplingCase>{zone, wave, band}));
  EXPECT_EQ(all.at("zone: buffer"), Cell(0.012));
  EXPECT_EQ(all.at("zone: zone"), Cell("faces"));
  EXPECT_EQ(all.count("zone: hysteresis"), 0U) << "it has none";
  EXPECT_EQ(all.at("wave: impedance"), Cell(7.0));
  EXPECT_EQ(all.at("wave: slave_mass"), Cell(0.1));
  EXPECT_EQ(all.at("wave: passivity_bound"), Cell(0.001));
  EXPECT_EQ(all.at("wave: passivity"), Cell("at the hand"));
  EXPECT_EQ(all.count("zone: passivity_bound"), 0U);
  EXPECT_EQ(all.at("ghost: mode"), Cell("lock-step"));
  EXPECT_EQ(all.at("ghost: deadband"), Cell(0.0005));
  EXPECT_EQ(all.at("ghost: fade_floor"), Cell(0.25));
  EXPECT_EQ(listed(parameters_of(FingerSettings{.mass_kg = 0.2})).at("finger: mass"), Cell(0.2));
}

TEST(Parameters, EverySchemeHasSome) {
  for (const coupling::Scheme scheme : coupling::kSchemes) {
    const CouplingCase of{.name = "one", .scheme = scheme};
    const auto all = listed(parameters_of(std::span(&of, 1)));
    EXPECT_EQ(all.at("one: scheme"), Cell(std::string(to_string(scheme))));
    EXPECT_EQ(all.at("one: fade_time"), Cell(0.1)) << to_string(scheme);
  }
}

TEST(Spread, AgreesWithTwoPassesOverTheNumbers) {
  Random random(7);
  std::vector<double> numbers;
  Spread spread;
  for (int i = 0; i < 1000; ++i) {
    numbers.push_back(random.uniform(-3, 9));
    spread.add(numbers.back());
  }
  double mean = 0;
  for (const double x : numbers) mean += x / 1000;
  double squares = 0;
  for (const double x : numbers) squares += (x - mean) * (x - mean);
  EXPECT_NEAR(spread.mean(), mean, 1e-12);
  EXPECT_NEAR(spread.deviation(), std::sqrt(squares / 999), 1e-12);
  EXPECT_EQ(spread.least(), *std::min_element(numbers.begin(), numbers.end()));
  EXPECT_EQ(spread.most(), *std::max_element(numbers.begin(), numbers.end()));
  EXPECT_EQ(spread.count(), 1000U);
}

TEST(RunAll, GivesEachOutcomeInItsPlaceAndTellsOfEachOnce) {
  std::vector<std::size_t> told;
  const auto squares = run_all(
      100, [](std::size_t i) { return i * i; },
      [&](std::size_t done, std::size_t all) {
        EXPECT_EQ(all, 100U);
        told.push_back(done);
      });
  ASSERT_EQ(squares.size(), 100U);
  for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ(squares[i], i * i);
  ASSERT_EQ(told.size(), 100U);
  for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ(told[i], i + 1);
}

// teleop.md 5 (G2) and 2(e), by hand: 1 mJ, 0.1 mJ for each contact, 50 N/m over 40 mm.
TEST(DeclaredEnergy, OnlyWhoHasACoordinateSpringDeclaresOne) {
  const CouplingCase ghost{.name = "ghost-point"};
  const CouplingCase planes{.name = "planes", .scheme = coupling::Scheme::ConstraintPlane};
  const CouplingCase printed{.name = "printed", .scheme = coupling::Scheme::ThesisLiteral};
  EXPECT_DOUBLE_EQ(declared_joule(ghost, 3, 0), 1e-3);
  EXPECT_DOUBLE_EQ(declared_joule(ghost, 3, 0.04), 1e-3 + 0.3e-3 + 40e-3);
  EXPECT_DOUBLE_EQ(declared_joule(printed, 3, 0.04), 1e-3 + 0.3e-3 + 40e-3);
  EXPECT_DOUBLE_EQ(declared_joule(planes, 3, 0.04), 1e-3 + 0.3e-3);
  CouplingCase hard = planes;
  hard.settings.constraint_plane.stiffness.newton_per_m = 1600;
  EXPECT_DOUBLE_EQ(declared_joule(hard, 3, 0.04), 1e-3 + 0.6e-3);
}

}  // namespace
}  // namespace thimble::lab
