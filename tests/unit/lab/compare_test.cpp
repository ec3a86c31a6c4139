// lint: long-file one experiment, each of its scenarios and what is made of them
#include "lab/compare/compare.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "lab/compare/bounded.hpp"
#include "lab/compare/compared.hpp"
#include "lab/compare/judged.hpp"
#include "lab/compare/scenarios.hpp"
#include "lab/trial/plane_fit.hpp"
#include "lab/trial/random.hpp"

namespace thimble::lab {
namespace {

Measures measures_of(const CouplingCase& of, const StageSettings& settings) {
  const auto measured = measure(of, settings);
  EXPECT_TRUE(measured) << measured.error().message;
  return measured.value_or(Measures{});
}

std::size_t place(Metric metric) { return static_cast<std::size_t>(metric); }
std::size_t place(Gate gate) { return static_cast<std::size_t>(gate); }

// teleop.md section 3: "Undelayed: hold force 3.20 N".
TEST(Compare, UndelayedIsAsTheFactsHaveIt) {
  const Measures found = measures_of(reference_scheme(), {});
  EXPECT_NEAR(found.hold_newton, 3.2, 0.05);
  EXPECT_NEAR(found.probed.stiffness_newton_per_m, 800, 5);
  EXPECT_LE(found.probed.onset_s, 0.005);
  EXPECT_LT(found.probed.displacement_m, 0.001);
  EXPECT_EQ(found.drag_newton, 0);
  EXPECT_NEAR(found.mass_kg, 0, 1e-12);
  EXPECT_EQ(found.missed_share, 0);
  EXPECT_LT(found.push_error_newton, 1e-6);
  EXPECT_LT(found.edge_m, 0.001);
  EXPECT_EQ(found.residue_newton, 0);
}

// The same section's table: hold force of (e) streamed and of (a), and what (a) does at 20 ms.
TEST(Compare, DelayedIsAsTheFactsHaveIt) {
  const CouplingCase ghost{.name = "ghost-point"};
  EXPECT_NEAR(measures_of(ghost, {.delay_s = 0.005}).hold_newton, 3.1, 0.1);
  EXPECT_NEAR(measures_of(ghost, {.delay_s = 0.02}).hold_newton, 2.7, 0.1);
  const Measures at_50 = measures_of(ghost, {.delay_s = 0.05});
  EXPECT_NEAR(at_50.hold_newton, 1.9, 0.1);
  EXPECT_NEAR(at_50.probed.onset_s, 0.05, 0.002);
  EXPECT_NEAR(at_50.probed.displacement_m, 0.0097, 0.0006);
  EXPECT_LT(at_50.swing_m, 1e-6);
  const CouplingCase remote{.name = "remote-force", .scheme = coupling::Scheme::RemoteForce};
  const Measures swinging = measures_of(remote, {.delay_s = 0.02});
  EXPECT_GT(swinging.swing_m, 0.02);
  EXPECT_GT(swinging.generated_joule, 1);
}

TEST(Compare, MarksSayWhatIsAmissAndWhereAGateFails) {
  Measures ideal;
  ideal.probed.stiffness_newton_per_m = 800;
  ideal.hold_newton = 3.2;
  const Marks none = marks_of(ideal, ideal, false);
  for (const double mark : none.metrics) EXPECT_EQ(mark, 0);
  for (const bool fails : none.fails) EXPECT_FALSE(fails);

  Measures poor = ideal;
  poor.probed.onset_s = 0.05;
  poor.probed.stiffness_newton_per_m = 400;
  poor.probed.displacement_m = std::numeric_limits<double>::quiet_NaN();
  poor.hold_newton = 1.6;
  poor.push_error_newton = 1;
  poor.mass_kg = -0.25;
  poor.drag_newton = 0.5;
  poor.swing_m = 0.001;
  poor.most_pull_newton = 0.2;
  const Marks marks = marks_of(poor, ideal, false);
  EXPECT_DOUBLE_EQ(marks.metrics[place(Metric::Onset)], 0.5);
  EXPECT_DOUBLE_EQ(marks.metrics[place(Metric::Stiffness)], 0.5);
  EXPECT_DOUBLE_EQ(marks.metrics[place(Metric::Displacement)], kWorst);
  EXPECT_DOUBLE_EQ(marks.metrics[place(Metric::Hold)], 0.5);
  EXPECT_DOUBLE_EQ(marks.metrics[place(Metric::Drag)], 0.75);
  EXPECT_TRUE(marks.fails[place(Gate::Bounded)]);
  EXPECT_TRUE(marks.fails[place(Gate::NotAttractive)]);
  EXPECT_FALSE(marks.fails[place(Gate::Passive)]);
  EXPECT_FALSE(marks.fails[place(Gate::Smooth)]);
  EXPECT_FALSE(marks_of(poor, ideal, true).fails[place(Gate::Bounded)]) << "the wall moved it";
}

TEST(Compare, EachReadingBesideChangesWhatItSaysAndNothingElse) {
  Measures ideal;
  ideal.probed.stiffness_newton_per_m = 800;
  ideal.hold_newton = 3.2;
  ideal.bytes_per_s = 278e3;
  Measures found = ideal;
  found.probed.onset_s = 0.02;
  found.probed_near = {.onset_s = 0.01, .stiffness_newton_per_m = 400, .displacement_m = 0.005};
  found.most_rise_newton = 1.5;
  found.packets_per_s = 2000;
  found.bytes_per_s = 2 * ideal.bytes_per_s;
  const Marks decided = marks_of(found, ideal, false);
  EXPECT_DOUBLE_EQ(decided.metrics[place(Metric::Traffic)], 1);
  EXPECT_FALSE(decided.fails[place(Gate::Smooth)]);
  const Marks letter = marks_of(found, ideal, false, Reading::RiseOf1Newton);
  EXPECT_TRUE(letter.fails[place(Gate::Smooth)]);
  EXPECT_EQ(letter.metrics, decided.metrics);
  const Marks bytes = marks_of(found, ideal, false, Reading::WithBytes);
  EXPECT_DOUBLE_EQ(bytes.metrics[place(Metric::Traffic)], 1.5);
  EXPECT_EQ(bytes.fails, decided.fails);
  const Marks near = marks_of(found, ideal, false, Reading::ProbedNear);
  EXPECT_DOUBLE_EQ(near.metrics[place(Metric::Onset)], 0.1);
  EXPECT_DOUBLE_EQ(near.metrics[place(Metric::Stiffness)], 0.5);
  EXPECT_DOUBLE_EQ(near.metrics[place(Metric::Displacement)], 0.1);
  EXPECT_EQ(near.metrics[place(Metric::Traffic)], decided.metrics[place(Metric::Traffic)]);
}

// A zone of 30 mm is full at rest when the hand comes from there; from 60 mm it has to be filled.
TEST(Compare, AHandThatComesFromNearFindsAZoneFull) {
  const CouplingCase zone{.name = "buffer-zone", .scheme = coupling::Scheme::BufferZone};
  Measures found;
  ASSERT_TRUE(play_probe(zone, {.delay_s = 0.5}, found));
  EXPECT_GT(found.probed.onset_s, 0.1);
  EXPECT_LT(found.probed_near.onset_s, 0.01);
}

TEST(Compare, ThoseBesideAreOtherFormsUnderNamesOfTheirOwn) {
  std::set<std::string> names;
  for (const CouplingCase& one : compared_schemes()) names.insert(one.name);
  for (const CouplingCase& one : schemes_beside()) {
    EXPECT_TRUE(names.insert(one.name).second) << one.name;
  }
  EXPECT_EQ(schemes_beside().size(), 3U);
  EXPECT_EQ(schemes_beside()[2].mode, link::SendMode::LockStep) << "as it is printed";
}

// 3.2 N, a cell of 3 mm, 800 N/m.
TEST(Bounded, TheWallPutsInWhatItDoesToTheHandAndToTheSpring) {
  EXPECT_NEAR(wall_work_joule(), 3.2 * 0.003 + 800 * 0.003 * 0.003 / 2, 1e-12);
}

TEST(Bounded, EachThingThatGrowsIsSeen) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const HeldAtWall good{
      .swing_before_m = 0.003, .swing_last_m = 0.0031, .most_newton = 4, .given_joule = 0.003};
  EXPECT_TRUE(is_bounded(good));
  for (const double swing_m : {0.005, kNone}) {
    HeldAtWall grows = good;
    grows.swing_last_m = swing_m;
    EXPECT_FALSE(is_bounded(grows));
  }
  for (const double newton : {9.0, kNone}) {
    HeldAtWall hard = good;
    hard.most_newton = newton;
    EXPECT_FALSE(is_bounded(hard));
  }
  for (const double joule : {wall_work_joule() + 1e-6, kNone}) {
    HeldAtWall driven = good;
    driven.given_joule = joule;
    EXPECT_FALSE(is_bounded(driven)) << "a swing that has come to its end is one, too";
  }
}

TEST(Bounded, TheoryHasNoBoundForTheRemoteClosedLoopAlone) {
  for (const coupling::Scheme scheme : coupling::kSchemes) {
    const bool is_remote = scheme == coupling::Scheme::RemoteForce;
    for (const double late_s : {0.005, 0.02, 0.201, 0.7}) {
      EXPECT_EQ(may_grow(scheme, late_s), is_remote);
    }
    EXPECT_FALSE(may_grow(scheme, 0.001)) << "the finger's 4 N s/m hold it";
  }
}

HeldAtWall held_by(const CouplingCase& of, const StageSettings& settings) {
  Measures measures;
  EXPECT_TRUE(play_hold(of, settings, measures));
  return measures.held;
}

TEST(Hold, IsBoundedBeforeAWallThatMovesButForALateRemoteForce) {
  for (const CouplingCase& of : compared_schemes()) {
    for (const double delay_s : {0.001, 0.05, 0.5}) {
      const bool may = may_grow(of.scheme, delay_s);
      EXPECT_EQ(is_bounded(held_by(of, {.delay_s = delay_s, .moves = true})), !may)
          << of.name << " " << delay_s;
    }
  }
}

// What has grown to where the arm's force ends grows no more: energy and force tell it.
TEST(Hold, ASwingThatHasComeToItsEndIsToldByWhatItIsGiven) {
  const CouplingCase remote{.name = "remote-force", .scheme = coupling::Scheme::RemoteForce};
  const HeldAtWall held = held_by(remote, {.delay_s = 0.02, .moves = true});
  EXPECT_LT(held.swing_last_m, kGrowsTo_ratio * held.swing_before_m + kGrows_m);
  EXPECT_GT(held.given_joule, 20 * wall_work_joule());
  EXPECT_GT(held.most_newton, 2 * kMost_newton);
}

// Each time the wall comes forward the frame goes with it, and does not return while the hand
// leans: bounded, but the wall is lost. A zone is felt where it is.
TEST(Hold, AFrameThatShiftsGivesWayToAWallThatComesAgainAndAgain) {
  const CouplingCase ours{.name = "composite", .scheme = coupling::Scheme::Composite};
  const CouplingCase zone{.name = "buffer-zone", .scheme = coupling::Scheme::BufferZone};
  const StageSettings moving{.delay_s = 0.02, .moves = true};
  EXPECT_LT(held_by(ours, moving).last_newton, 0.8);
  EXPECT_GT(held_by(zone, moving).last_newton, 3.2);
  EXPECT_NEAR(held_by(ours, {.delay_s = 0.02}).last_newton, 3.2, 0.05) << "one that stays is not";
}

Felt felt_at(double velocity_m_per_s, double newton) {
  Felt felt;
  felt.velocity.x = velocity_m_per_s;
  felt.force.x = -newton;
  felt.is_in_contact = true;
  return felt;
}

// 2 N are a hand's of 0.2 m/s; an undelayed wall of 800 N/m and 5 N s/m adds 5.8 N for each m/s.
TEST(Judged, ARiseIsThatOfAHandOfTheUsualSpeed) {
  Measures slow;
  judge_forces({felt_at(0.2, 0), felt_at(0.2, 2.4), felt_at(0.2, 0.1)}, slow);
  EXPECT_DOUBLE_EQ(slow.most_rise_newton, 2.4);
  EXPECT_DOUBLE_EQ(slow.most_jump_newton, 2.4) << "and what falls is no rise";
  EXPECT_DOUBLE_EQ(slow.most_newton, 2.4);
  Measures fast;
  judge_forces({felt_at(0.4, 0), felt_at(0.4, 2.4)}, fast);
  EXPECT_DOUBLE_EQ(fast.most_rise_newton, 2.4);
  EXPECT_NEAR(fast.most_jump_newton, 2.4 - 5.8 * 0.2, 1e-12);
}

TEST(Judged, WhatRisesWhereAHandTurnsAtOnceIsItsOwn) {
  Measures turned;
  judge_changes({felt_at(0.2, 1), felt_at(-0.2, 9), felt_at(-0.2, 9.5), felt_at(-0.2, -0.3)},
                turned);
  EXPECT_DOUBLE_EQ(turned.most_rise_newton, 0.5);
  EXPECT_DOUBLE_EQ(turned.most_pull_newton, 0.3);
  EXPECT_EQ(turned.most_newton, 0) << "how deep it goes it decides by itself";
}

TEST(Judged, TheWorstOfAllScenariosIsKeptAndWhatIsNoNumberIsTheWorst) {
  Measures measures;
  judge_forces({felt_at(0, 0), felt_at(0, 3)}, measures);
  judge_forces({felt_at(0, 0), felt_at(0, 1)}, measures);
  EXPECT_DOUBLE_EQ(measures.most_newton, 3);
  judge_forces({felt_at(0, std::nan(""))}, measures);
  judge_forces({felt_at(0, 0), felt_at(0, 1)}, measures);
  EXPECT_TRUE(std::isnan(measures.most_newton));
}

// Each by itself: the remote closed loop fails in all of them.
TEST(Judged, NoScenarioOfAFingerIsWithoutAGate) {
  const CouplingCase remote{.name = "remote-force", .scheme = coupling::Scheme::RemoteForce};
  for (const auto play : {play_approach, play_push, play_edge, play_outage}) {
    Measures late;
    ASSERT_TRUE(play(remote, {.delay_s = 0.02}, late));
    EXPECT_GT(late.generated_joule, 100 * late.declared_joule);
    EXPECT_GT(late.most_newton, kMost_newton);
    EXPECT_GT(late.most_rise_newton, 0);
    Measures local;
    ASSERT_TRUE(play({.name = "ghost-point"}, {.delay_s = 0.02}, local));
    EXPECT_LE(local.generated_joule, local.declared_joule);
    EXPECT_GT(local.most_newton, 0);
    EXPECT_LT(local.most_newton, kMost_newton);
  }
  Measures taps;
  const CouplingCase wave{.name = "wave", .scheme = coupling::Scheme::Wave};
  ASSERT_TRUE(play_taps(wave, {.delay_s = 0.02}, taps));
  EXPECT_GT(taps.most_pull_newton, 0.1);
  EXPECT_GT(taps.most_rise_newton, 0);
}

// K_c is held below B/T of the delay, and a silence stretches the spring all the same.
TEST(Judged, ASpringKicksWhenANetworkIsBackThatWasSilent) {
  const CouplingCase spring{.name = "spring", .scheme = coupling::Scheme::SpringDamper};
  Measures steady;
  ASSERT_TRUE(play_edge(spring, {.delay_s = 0.005}, steady));
  EXPECT_LE(steady.generated_joule, steady.declared_joule);
  Measures silent;
  ASSERT_TRUE(play_edge(spring, {.delay_s = 0.005, .has_outages = true}, silent));
  EXPECT_GT(silent.most_newton, kMost_newton);
  EXPECT_GT(silent.generated_joule, silent.declared_joule);
  EXPECT_TRUE(may_give(spring.scheme, true));
  EXPECT_FALSE(may_give(spring.scheme, false));
  EXPECT_TRUE(may_give(coupling::Scheme::RemoteForce, false));
  EXPECT_FALSE(may_give(coupling::Scheme::Wave, true));
  EXPECT_TRUE(may_ask_for_more(spring.scheme));
  EXPECT_FALSE(may_ask_for_more(coupling::Scheme::Wave));
}

TEST(Compare, ARunIsTheSameAgainAndOfAnotherSeedItIsNot) {
  const CouplingCase ghost{.name = "ghost-point"};
  const StageSettings rough{.delay_s = 0.05, .jitter_s = 0.025, .loss = 0.05, .seed = 3};
  StageSettings other = rough;
  other.seed = 4;
  const double once = measures_of(ghost, rough).hold_newton;
  EXPECT_EQ(measures_of(ghost, rough).hold_newton, once);
  EXPECT_NE(measures_of(ghost, other).hold_newton, once);
}

// All scenarios of the lab: a probe, an approach, a push, an edge, taps, outages, a shake. Not each
// network at each delay: that would take twice as long.
TEST(Compare, ADeadbandSendsAQuarterAndFailsNoGate) {
  constexpr double kBand_m = 0.0005;
  constexpr double kLoss = 0.05;
  const std::vector<StageSettings> stages{{.delay_s = 0.001},
                                          {.delay_s = 0.001, .loss = kLoss},
                                          {.delay_s = 0.02},
                                          {.delay_s = 0.02, .jitter_s = 0.01},
                                          {.delay_s = 0.02, .loss = kLoss},
                                          {.delay_s = 0.02, .has_outages = true},
                                          {.delay_s = 0.1, .jitter_s = 0.05},
                                          {.delay_s = 0.1, .has_outages = true},
                                          {.delay_s = 0.2},
                                          {.delay_s = 0.2, .loss = kLoss},
                                          {.delay_s = 0.5},
                                          {.delay_s = 0.5, .jitter_s = 0.25},
                                          {.delay_s = 0.5, .has_outages = true}};
  const Measures reference = measures_of(reference_scheme(), {});
  for (const auto scheme : {coupling::Scheme::GhostPoint, coupling::Scheme::ConstraintPlane}) {
    for (StageSettings stage : stages) {
      stage.seed = 3;
      SCOPED_TRACE(std::string(to_string(scheme)) + ", " + std::to_string(stage.delay_s) + " s, " +
                   std::to_string(stage.jitter_s) + " s, " + std::to_string(stage.loss));
      const Measures whole = measures_of({.name = "whole", .scheme = scheme}, stage);
      const Measures banded =
          measures_of({.name = "banded", .scheme = scheme, .deadband_m = kBand_m}, stage);
      EXPECT_LT(4 * banded.packets_per_s, whole.packets_per_s);
      for (const bool fails : marks_of(banded, reference, false).fails) EXPECT_FALSE(fails);
      EXPECT_LE(banded.generated_joule, banded.declared_joule);
      // A loss costs what the hand moves until something is sent again.
      const double lost_m = stage.loss > 0 ? 0.2 * seconds(link::Deadband::kMaxGap) : 0;
      // The hand that nothing stops is at the end of its reach before it feels a wall of 500 ms.
      EXPECT_EQ(std::isnan(banded.probed.displacement_m), std::isnan(whole.probed.displacement_m));
      if (!std::isnan(whole.probed.displacement_m)) {
        EXPECT_LE(banded.probed.displacement_m, whole.probed.displacement_m + kBand_m + lost_m);
      }
      EXPECT_NEAR(banded.hold_newton, whole.hold_newton, 800 * (kBand_m + lost_m));
    }
  }
}

// The third that takes one. It is given what its defects give (teleop.md 7), and has no bounds to
// keep; but what a hand feels of it stays.
TEST(Compare, ADeadbandSendsAQuarterOfThePrintedCallbacksToo) {
  constexpr double kBand_m = 0.0005;
  constexpr auto kPrinted = coupling::Scheme::ThesisLiteral;
  for (const double delay_s : {0.001, 0.02, 0.1, 0.2, 0.5}) {
    const StageSettings stage{.delay_s = delay_s, .loss = 0.05, .seed = 3};
    const Measures whole = measures_of({.name = "whole", .scheme = kPrinted}, stage);
    const Measures banded =
        measures_of({.name = "banded", .scheme = kPrinted, .deadband_m = kBand_m}, stage);
    EXPECT_LT(4 * banded.packets_per_s, whole.packets_per_s) << delay_s;
    EXPECT_NEAR(banded.hold_newton, whole.hold_newton, 1) << delay_s;
    // It has no clamp (defect 11), and a finger that flies at it is pushed by more than 8.5 N.
    EXPECT_NEAR(banded.most_newton, whole.most_newton, 1) << delay_s;
    EXPECT_LT(banded.swing_m, 0.0005) << delay_s;
  }
}

TEST(Compare, EachSchemeIsComparedUnderANameOfItsOwn) {
  std::set<std::string> names;
  std::set<coupling::Scheme> schemes;
  for (const CouplingCase& one : compared_schemes()) {
    EXPECT_TRUE(names.insert(one.name).second) << one.name;
    schemes.insert(one.scheme);
  }
  // All but the printed callback, which is to be shown, not used.
  EXPECT_EQ(schemes.size(), coupling::kSchemes.size() - 1);
}

TEST(Stage, TheWallMovesAndTheNetworkFallsSilentWhenTheyAreSaidTo) {
  // The hand rests 1 mm before the wall, inside the cell that is filled from 0.7 s on.
  const Position3 before{kWall_m - 0.001, -0.02, 0};
  auto stage = Stage::create({.name = "ghost-point"}, {.moves = true}, before);
  ASSERT_TRUE(stage) << stage.error().message;
  double first_s = 0;
  while ((*stage)->now_s() < 1.0) {
    const Felt& felt = (*stage)->tick(before, {});
    if (felt.is_in_contact && first_s == 0) first_s = felt.now_s;
  }
  EXPECT_NEAR(first_s, kMoveEvery_s, 0.005);

  auto silent = Stage::create({.name = "ghost-point"}, {.has_outages = true}, before);
  ASSERT_TRUE(silent);
  while ((*silent)->now_s() < kOutageEvery_s) (void)(*silent)->tick(before, {});
  EXPECT_NEAR((*silent)->packets_per_s(), 2000 * (1 - kOutage_s / kOutageEvery_s), 5);
}

// A map costs bytes until it is known, and then no more than faces do.
TEST(Stage, BytesAreThoseOfTheDatagramsThatGoToAndFro) {
  const Position3 before{kWall_m - 0.010, -0.02, 0};
  const auto bytes_per_s = [&](const CouplingCase& of) {
    auto stage = Stage::create(of, {.delay_s = 0.01}, before);
    EXPECT_TRUE(stage);
    for (int i = 0; i < 500; ++i) (void)(*stage)->tick(before, {});
    const bool waits = of.mode == link::SendMode::LockStep;
    EXPECT_NEAR((*stage)->packets_per_s(), waits ? 2 / 0.010 : 2000, 20);
    return (*stage)->bytes_per_s();
  };
  const double faces = bytes_per_s({.name = "ghost-point"});
  EXPECT_GT(faces, 2000 * 64.0);
  EXPECT_LT(faces, 2000 * 256.0);
  const double map = bytes_per_s({.name = "composite", .scheme = coupling::Scheme::Composite});
  EXPECT_GT(map, faces);
  EXPECT_LT(map, 1.5 * faces);
  const double zone = bytes_per_s({.name = "buffer-zone", .scheme = coupling::Scheme::BufferZone});
  EXPECT_GT(zone, map) << "it names what is near again and again";
}

TEST(PlaneFit, FindsTheSlopesItWasGiven) {
  Random random(5);
  PlaneFit fit;
  PlaneFit flat;
  for (int i = 0; i < 500; ++i) {
    const double x = random.uniform(-1, 1);
    const double y = random.uniform(-3, 1);
    fit.add(x, y, 7 + 800 * x - 5 * y);
    flat.add(2, y, y);
  }
  EXPECT_NEAR(fit.slope(), 800, 1e-9);
  EXPECT_NEAR(fit.spread(), 1 / std::sqrt(3), 0.05);
  EXPECT_TRUE(std::isnan(flat.slope())) << "points of one x tell no slope along it";
}

}  // namespace
}  // namespace thimble::lab
