#include "lab/compare/measures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "lab/compare/judged.hpp"
#include "lab/compare/scenarios.hpp"
#include "lab/trial/declared_energy.hpp"

namespace thimble::lab {
namespace {

// SOURCE of what metrics are divided by, and of the gates: teleop.md section 5 and decision 0441.
constexpr double kOnset_s = 0.1;
constexpr double kDisplacement_m = 0.05;
constexpr double kDrag_newton = 1;
constexpr double kMass_kg = 1;
constexpr double kPush_newton = 2;
constexpr double kResidue_newton = 1;
constexpr double kEdge_m = 0.01;
constexpr double kAstray_newton = 1;
constexpr double kAstray_s = 1;
constexpr double kPackets_per_s = 2000;
constexpr double kSwing_m = 0.0005;
constexpr double kRise_newton = 2;
constexpr double kLiteralRise_newton = 1;  // teleop.md section 5, G3
constexpr double kPull_newton = 0.1;

}  // namespace

Result<Measures> measure(const CouplingCase& of, const StageSettings& settings) {
  Measures measures;
  for (const auto play :
       {play_probe, play_approach, play_push, play_edge, play_taps, play_outage, play_shake}) {
    if (const auto played = play(of, settings, measures); !played) {
      return tl::unexpected(played.error());
    }
  }
  if (!settings.moves) return measures;
  if (const auto played = play_hold(of, settings, measures); !played) {
    return tl::unexpected(played.error());
  }
  return measures;
}

std::string_view to_string(Reading reading) noexcept {
  constexpr std::array<std::string_view, 4> kNames{"decided", "rise_of_1_newton", "with_bytes",
                                                   "probed_from_30_mm"};
  return kNames[static_cast<std::size_t>(reading)];
}

Marks marks_of(const Measures& measures, const Measures& reference, bool moves,
               Reading reading) noexcept {
  const bool is_near = reading == Reading::ProbedNear;
  const bool is_literal = reading == Reading::RiseOf1Newton;
  const Probed& probed = is_near ? measures.probed_near : measures.probed;
  const double wall = coupling::GhostPointSettings{}.stiffness.newton_per_m;
  const double hold_error = std::abs(measures.hold_newton / reference.hold_newton - 1);
  const auto mean = [](double a, double b) { return (a + b) / 2; };
  Marks marks;
  const auto give = [&](Metric metric, double value) {
    marks.metrics[static_cast<std::size_t>(metric)] = bounded_mark(value);
  };
  give(Metric::Onset, probed.onset_s / kOnset_s);
  give(Metric::Stiffness, std::abs(probed.stiffness_newton_per_m / wall - 1));
  give(Metric::Displacement, probed.displacement_m / kDisplacement_m);
  give(Metric::Drag, measures.drag_newton / kDrag_newton + std::abs(measures.mass_kg) / kMass_kg);
  give(Metric::Hold, mean(measures.push_error_newton / kPush_newton, hold_error));
  give(Metric::Residue, measures.residue_newton / kResidue_newton);
  give(Metric::Edge, (measures.edge_m - reference.edge_m) / kEdge_m);
  give(Metric::MissedTaps, measures.missed_share);
  give(Metric::Recovery,
       mean(measures.astray_newton / kAstray_newton, measures.astray_s / kAstray_s));
  const double packets = measures.packets_per_s / kPackets_per_s;
  const double bytes = measures.bytes_per_s / reference.bytes_per_s;
  give(Metric::Traffic, reading == Reading::WithBytes ? mean(packets, bytes) : packets);
  const auto fail_if = [&](Gate gate, bool fails) {
    marks.fails[static_cast<std::size_t>(gate)] = fails;
  };
  // Written so that what is not a number fails. A wall that moves moves the hand, and works on it.
  fail_if(Gate::Bounded, !moves && !(measures.swing_m < kSwing_m));
  fail_if(Gate::Passive, !(measures.generated_joule <= measures.declared_joule));
  const bool is_smooth = is_literal ? measures.most_rise_newton <= kLiteralRise_newton
                                    : measures.most_jump_newton <= kRise_newton;
  fail_if(Gate::Smooth, !(measures.most_newton <= kMost_newton && is_smooth));
  fail_if(Gate::NotAttractive, !(measures.most_pull_newton <= kPull_newton));
  return marks;
}

void list_gates(std::vector<Parameter>& into) {
  into.insert(into.end(), {{"yardstick: onset", "s", kOnset_s},
                           {"yardstick: displacement", "m", kDisplacement_m},
                           {"yardstick: drag", "N", kDrag_newton},
                           {"yardstick: mass", "kg", kMass_kg},
                           {"yardstick: push_error", "N", kPush_newton},
                           {"yardstick: residue", "N", kResidue_newton},
                           {"yardstick: edge", "m", kEdge_m},
                           {"yardstick: astray", "N", kAstray_newton},
                           {"yardstick: astray_for", "s", kAstray_s},
                           {"yardstick: packets", "1/s", kPackets_per_s},
                           {"worst_mark", "", kWorst},
                           {"same_score_within", "", kSameScore},
                           {"gate: swing", "m", kSwing_m},
                           {"gate: energy", "J", kPassive_joule},
                           {"gate: force", "N", kMost_newton},
                           {"gate: rise", "N", kRise_newton},
                           {"gate: rise_by_the_letter", "N", kLiteralRise_newton},
                           {"gate: pull", "N", kPull_newton},
                           {"gate: hand_of_the_rise", "m/s", kHandOfRise_m_per_s},
                           {"gate: hand_turns_beyond", "m/s", kJerk_m_per_s}});
}

}  // namespace thimble::lab
