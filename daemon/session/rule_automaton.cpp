#include "daemon/session/rule_automaton.hpp"

#include <bit>
#include <string>
#include <utility>

#include "daemon/session/zone_marker.hpp"
#include "hal/base/check.hpp"
#include "sim/model/cam/engine/plane_engine.hpp"

namespace thimble::session {
namespace {

using sim::cam::PlaneEngine;
using sim::cam::Rule;
using world::cam::AutomatonState;

class RuleAutomaton final : public world::cam::Automaton {
 public:
  RuleAutomaton(const Rule& rule, std::unique_ptr<PlaneEngine> engine)
      : rule_(&rule), engine_(std::move(engine)), sites_(engine_->space().sites()) {}

  [[nodiscard]] Result<void> begin(const sim::cam::Beginning& beginning) {
    if (auto loaded = engine_->load(0, sim::cam::table_of(*rule_)); !loaded) return loaded;
    return engine_->put(sim::cam::random_sites(*rule_, engine_->space(), beginning));
  }

  [[nodiscard]] CamAxes log2_cells() const noexcept override { return engine_->space().log2_cells; }
  [[nodiscard]] std::uint64_t steps() const noexcept override { return steps_; }
  void step() override {
    THIMBLE_CHECK(engine_->step(rule_->cycle[steps_ % rule_->cycle.size()], {}));
    ++steps_;
  }
  void read(std::span<std::uint64_t> matter) override {
    const auto layer = static_cast<std::size_t>(std::countr_zero(rule_->visible_layers()));
    THIMBLE_CHECK(engine_->get_layer(layer, matter));
  }
  void write(std::span<const std::uint64_t> changed,
             std::span<const std::uint64_t> matter) override {
    THIMBLE_CHECK(engine_->get(sites_));
    for (std::size_t i = 0; i < sites_.size(); ++i) {
      if ((changed[i / 64] >> (i % 64) & 1) == 0) continue;
      const bool is_matter = (matter[i / 64] >> (i % 64) & 1) != 0;
      sites_[i] = static_cast<std::uint16_t>((sites_[i] & ~rule_->visible_layers()) |
                                             (is_matter ? rule_->visible_layers() : 0));
    }
    THIMBLE_CHECK(engine_->put(sites_));
  }
  [[nodiscard]] bool mark_zone(std::int32_t cells, std::span<std::uint64_t> zone) override {
    if (!marker_) {
      auto made = ZoneMarker::make(log2_cells());
      if (!made) return false;
      marker_ = *std::move(made);
      matter_.resize(zone.size());
    }
    read(matter_);
    marker_->mark(matter_, cells, zone);
    return true;
  }
  [[nodiscard]] AutomatonState save() override {
    AutomatonState state{std::string(rule_->name), log2_cells(), steps_, {}};
    state.sites.resize(sites_.size());
    THIMBLE_CHECK(engine_->get(state.sites));
    return state;
  }
  [[nodiscard]] Result<void> load(const AutomatonState& state) override {
    if (state.rule != rule_->name) {
      return fail(Errc::InvalidArgument, "the saved state is of the rule " + state.rule +
                                             ", this world's is " + std::string(rule_->name));
    }
    if (state.log2_cells != log2_cells()) {
      return fail(Errc::InvalidArgument, "the saved state is of another number of cells");
    }
    if (auto put = engine_->put(state.sites); !put) return put;
    steps_ = state.steps;
    return {};
  }

 private:
  const Rule* rule_;
  std::unique_ptr<PlaneEngine> engine_;
  std::vector<std::uint16_t> sites_;    // room
  std::unique_ptr<ZoneMarker> marker_;  // where somebody wants a zone
  std::vector<std::uint64_t> matter_;   // room
  std::uint64_t steps_{0};
};

}  // namespace

Result<std::unique_ptr<world::cam::Automaton>> make_rule_automaton(
    const Rule& rule, const CamAxes& log2_cells, const sim::cam::Beginning& beginning) {
  auto engine = PlaneEngine::make({log2_cells}, sim::cam::TablePath::Auto);
  if (!engine) return tl::unexpected(engine.error());
  auto automaton = std::make_unique<RuleAutomaton>(rule, *std::move(engine));
  if (const auto begun = automaton->begin(beginning); !begun) return tl::unexpected(begun.error());
  return automaton;
}

}  // namespace thimble::session
