#include "daemon/world/cam/piece_rules.hpp"

#include <utility>

namespace thimble::world::cam {
namespace {

using namespace cell;

[[nodiscard]] std::uint16_t with_shown(std::uint16_t bits) noexcept {
  const int shown = (bits & kShape) != 0 ? kMostPieces : part_of(bits);
  return static_cast<std::uint16_t>((bits & ~kSelect) | selecting(shown));
}

[[nodiscard]] int selected_by(std::uint16_t bits) noexcept {
  return (bits & kSelect) >> kSelectLayer;
}

template <class Rule>
std::shared_ptr<const CamTable> table_of(Rule rule) {
  CamTable table(kCamTableEntries);
  for (std::size_t n = 0; n < table.size(); ++n) table[n] = rule(static_cast<std::uint16_t>(n));
  return std::make_shared<const CamTable>(std::move(table));
}

// Layers in which dynamic pieces have no number, and show none.
constexpr std::uint16_t kBeside = kParticles | kDice;
constexpr std::uint16_t kDynamicNumber = kMostDynamicPieces << kPartLayer;
constexpr std::uint16_t kNotShown = kSelect & ~selecting(kMostDynamicPieces);

// A rule of static pieces, which neither sees nor changes particles and dice.
template <std::uint16_t (*Rule)(std::uint16_t) noexcept>
std::uint16_t beside_particles(std::uint16_t bits) noexcept {
  const std::uint16_t after = Rule(static_cast<std::uint16_t>(bits & ~kBeside));
  return static_cast<std::uint16_t>((after & ~(kBeside | kNotShown)) | (bits & kBeside));
}

std::uint16_t dynamic_overlap_rule(std::uint16_t bits) noexcept {
  return beside_particles<overlap_rule>((bits & kDrift) != 0 ? drift_rule(bits) : bits);
}

std::uint16_t dynamic_deposit_rule(std::uint16_t bits) noexcept {
  const bool is_deleted = (bits & kShape) != 0 && selected_by(bits) == 0;
  return static_cast<std::uint16_t>(beside_particles<deposit_rule>(bits) |
                                    (is_deleted ? kParticles : 0));
}

}  // namespace

std::uint16_t overlap_rule(std::uint16_t bits) noexcept {
  const bool overlaps = part_of(bits) != 0 && (bits & kShape) != 0;
  const std::uint16_t marked =
      static_cast<std::uint16_t>((bits & ~kOverlap) | (overlaps ? kOverlap : 0));
  return with_shown(marked);
}

std::uint16_t grasp_rule(std::uint16_t bits) noexcept {
  const int grasped = (bits & kGrasp) != 0 ? part_of(bits) : 0;
  return static_cast<std::uint16_t>((bits & ~kSelect) | selecting(grasped));
}

std::uint16_t select_rule(std::uint16_t bits) noexcept {
  const bool is_chosen = selected_by(bits) != 0 && part_of(bits) == selected_by(bits);
  const std::uint16_t others = static_cast<std::uint16_t>(bits & ~(kOrigin | kShape));
  if (!is_chosen) return with_shown(others);
  return with_shown(static_cast<std::uint16_t>((others & ~kPart) | kOrigin | kShape));
}

std::uint16_t deposit_rule(std::uint16_t bits) noexcept {
  const int part = selected_by(bits);
  const bool is_filled = (bits & kShape) != 0 && part != 0;
  std::uint16_t after = static_cast<std::uint16_t>(bits & ~(kOrigin | kShape | kOverlap));
  if (is_filled) after = static_cast<std::uint16_t>((after & ~kPart) | of_part(part));
  if ((bits & kGrasp) != 0) after |= kShape;
  return with_shown(after);
}

std::uint16_t sweep_rule(std::uint16_t bits) noexcept {
  const bool begins = (bits & kBegins) != 0;
  const bool is_swept = (bits & (begins ? kShape : kTrail | kAhead)) != 0;
  const auto others = static_cast<std::uint16_t>(bits & ~kSelect);
  if (!is_swept) return others;
  return static_cast<std::uint16_t>(others | kTrail | kAhead | (part_of(bits) != 0 ? kHit : 0));
}

std::uint16_t drift_rule(std::uint16_t bits) noexcept {
  const bool is_dice = (bits & kDice) != 0;
  const bool is_matter = ((bits & kPart) & kDynamicNumber) != 0;
  if (is_matter) return static_cast<std::uint16_t>(bits & ~kParticles);
  if (is_dice && (bits & kEmit) != 0 && (bits & kShape) != 0) bits |= kParticles;
  const bool is_one = ((bits & kForth) != 0) != ((bits & kBack) != 0);
  return static_cast<std::uint16_t>(is_dice && is_one ? bits ^ kParticles : bits);
}

PieceTables make_piece_tables(bool is_dynamic, bool is_shown) {
  const auto table = [&](auto rule) {
    return table_of([&](std::uint16_t bits) {
      const std::uint16_t after = rule(bits);
      return is_shown ? after : static_cast<std::uint16_t>(after & ~kSelect);
    });
  };
  if (is_dynamic) {
    return {table(dynamic_overlap_rule), table_of(beside_particles<grasp_rule>),
            table(beside_particles<select_rule>), table(dynamic_deposit_rule),
            table_of(beside_particles<sweep_rule>)};
  }
  return {table(overlap_rule), table_of(grasp_rule), table(select_rule), table(deposit_rule),
          table_of(sweep_rule)};
}

}  // namespace thimble::world::cam
