#include "daemon/session/live_settings.hpp"

#include <bit>
#include <utility>

#include "daemon/session/rule_automaton.hpp"
#include "daemon/world/cam/live_world.hpp"

namespace thimble::session {
namespace {

[[nodiscard]] const sim::cam::Rule* rule_of(const config::WorldConfig& said) {
  if (said.source == "life") return sim::cam::find_rule("life");
  return sim::cam::find_rule(said.automaton->axes == 3 ? "dla-3d" : "dla");
}

}  // namespace

Result<std::unique_ptr<world::World>> make_live_world(const config::WorldConfig& said) {
  const config::AutomatonConfig& of = *said.automaton;
  const sim::cam::Rule* const rule = rule_of(said);
  const int log2 = std::countr_zero(static_cast<unsigned>(of.cells));
  if (rule == nullptr) return fail(Errc::NotFound, said.source + ": there is no such rule");
  auto automaton = make_rule_automaton(
      *rule, {log2, log2, of.axes == 3 ? log2 : 0},
      {.seed = of.seed, .fill_fraction = of.fill_fraction, .is_for_pattern = false});
  if (!automaton) return tl::unexpected(automaton.error().in(said.source));
  auto world = world::cam::LiveWorld::create(
      {said.workspace_m, of.steps_per_s, of.poke_cells, said.source}, *std::move(automaton));
  if (!world) return tl::unexpected(world.error());
  return *std::move(world);
}

}  // namespace thimble::session
