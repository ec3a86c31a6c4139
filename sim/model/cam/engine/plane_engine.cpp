#include "sim/model/cam/engine/plane_engine.hpp"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

namespace thimble::sim::cam {
namespace {

constexpr std::size_t kEntries = std::size_t{1} << kPlanes;

bool has(LayerBits layers, std::size_t layer) { return (layers >> layer & 1) != 0; }
LayerBits with(LayerBits layers, std::size_t layer) {
  return static_cast<LayerBits>(layers | 1U << layer);
}

Result<void> check_sites(std::size_t given, const SiteSpace& space) {
  if (given == space.sites()) return {};
  return fail(Errc::InvalidArgument,
              std::to_string(given) + " sites for a space of " + std::to_string(space.sites()));
}

// Sites of the last block that a space smaller than a block does not have.
struct alignas(64) SiteBlock {
  std::array<std::uint16_t, kBlockSites> sites{};
};

}  // namespace

Result<std::unique_ptr<PlaneEngine>> PlaneEngine::make(const SiteSpace& space, TablePath path,
                                                       const VectorKernels& kernels) {
  if (Result<void> checked = check_space(space); !checked) return tl::unexpected(checked.error());
  return std::unique_ptr<PlaneEngine>(new PlaneEngine(space, path, kernels));
}

PlaneEngine::PlaneEngine(const SiteSpace& space, TablePath path, const VectorKernels& kernels)
    : path_(path),
      kernels_(&kernels),
      planes_(space, kernels),
      rooms_(PlaneRule::kFirstRoom),
      places_(PlaneRule::kFirstRoom) {
  constants_[1].words.fill(~Word{0});
  std::vector<std::uint16_t> identity(kEntries);
  std::iota(identity.begin(), identity.end(), std::uint16_t{0});
  for (Table& table : tables_) {
    table.entries = identity;
    table.shape = shape_of(identity);
    table.rule = compile_rule(identity);
  }
}

Result<void> PlaneEngine::put(std::span<const std::uint16_t> sites) {
  if (Result<void> checked = check_sites(sites.size(), space()); !checked) return checked;
  std::array<SitePlanes::Plane, kPlanes> planes{};
  std::generate(planes.begin(), planes.end(), [&] { return planes_.claim(); });
  SiteBlock padded;
  for (std::size_t block = 0; block < planes_.blocks(); ++block) {
    const auto here = sites.subspan(block * kBlockSites, std::min(kBlockSites, sites.size()));
    std::copy(here.begin(), here.end(), padded.sites.begin());
    std::array<Word*, kPlanes> out{};
    std::transform(planes.begin(), planes.end(), out.begin(),
                   [&](SitePlanes::Plane plane) { return planes_.block_of(plane, block); });
    kernels_->from_sites(padded.sites.data(), out.data());
  }
  for (std::size_t layer = 0; layer < kPlanes; ++layer) planes_.show(layer, planes[layer]);
  planes_.release_unused();
  return {};
}

Result<void> PlaneEngine::get(std::span<std::uint16_t> sites) {
  if (Result<void> checked = check_sites(sites.size(), space()); !checked) return checked;
  SiteBlock padded;
  for (std::size_t block = 0; block < planes_.blocks(); ++block) {
    std::array<const Word*, kPlanes> in{};
    for (std::size_t layer = 0; layer < kPlanes; ++layer) {
      in[layer] = planes_.fetch(layer, block, rooms_[layer].words.data());
    }
    kernels_->to_sites(in.data(), padded.sites.data());
    const auto here = sites.subspan(block * kBlockSites, std::min(kBlockSites, sites.size()));
    std::copy_n(padded.sites.begin(), here.size(), here.begin());
  }
  return {};
}

Result<void> PlaneEngine::get_layer(std::size_t layer, std::span<Word> bits) {
  if (layer >= kPlanes || bits.size() != space().sites() / kWordSites) {
    return fail(Errc::InvalidArgument, "there are layers 0 to 15, a word for 64 sites of each");
  }
  const std::size_t words = planes_.words_of_block();
  for (std::size_t block = 0; block < planes_.blocks(); ++block) {
    const Word* const from = planes_.fetch(layer, block, rooms_[layer].words.data());
    std::copy_n(from, words, bits.begin() + static_cast<std::ptrdiff_t>(block * words));
  }
  return {};
}

Result<void> PlaneEngine::load(std::size_t bank, std::span<const std::uint16_t> entries) {
  if (bank >= kBanks || entries.size() != kEntries) {
    return fail(Errc::InvalidArgument, "a table has 65536 entries and goes into bank 0 or 1");
  }
  Table table{{entries.begin(), entries.end()}, shape_of(entries), std::nullopt};
  if (path_ != TablePath::General) {
    table.rule =
        compile_rule(entries, path_ == TablePath::Auto ? kernels_->worth_ops : kMostPlaneOps);
  }
  if (table.rule && !does_as_table(*table.rule, entries, *kernels_)) {
    return fail(Errc::Unsupported,
                "the compiled table does not do as the table: a mistake of ours");
  }
  if (path_ == TablePath::Compiled && !table.rule) {
    return fail(Errc::Unsupported, "the table takes more than " + std::to_string(kMostPlaneOps) +
                                       " operations on planes: look it up");
  }
  if (table.rule) {
    rooms_.resize(std::max(rooms_.size(), PlaneRule::kFirstRoom + table.rule->rooms));
    places_.resize(rooms_.size());
    for (std::size_t i = PlaneRule::kFirstRoom; i < rooms_.size(); ++i) {
      places_[i] = rooms_[i].words.data();
    }
  }
  tables_[bank] = std::move(table);
  return {};
}

Result<PlaneCounts> PlaneEngine::step(std::span<const PlaneKick> kicks,
                                      const StepOptions& options) {
  if (options.bank >= kBanks) return fail(Errc::InvalidArgument, "there are banks 0 and 1");
  planes_.kick(kicks);
  Plan plan = make_plan(options);
  if (plan.made != 0) {
    for (std::size_t block = 0; block < planes_.blocks(); ++block) work(plan, block);
  }
  const PlaneCounts counts = counts_of(plan);
  finish(plan);
  return counts;
}

PlaneEngine::Plan PlaneEngine::make_plan(const StepOptions& options) {
  Plan plan{.table = &tables_[options.bank], .options = options};
  plan.kept = static_cast<LayerBits>(plan.table->shape.kept & ~options.fixed);
  const bool counts_all = options.counting == Counting::Outputs;
  for (std::size_t layer = 0; layer < kPlanes; ++layer) {
    const bool is_written = has(options.written, layer);
    if (has(plan.kept, layer) || !(is_written || counts_all)) continue;
    const std::size_t source = plan.table->rule ? plan.table->rule->same_as[layer] : layer;
    plan.source[layer] = static_cast<std::uint8_t>(source);
    plan.made = with(plan.made, source);
    if (is_written && !plan.planes[source]) plan.planes[source] = planes_.claim();
  }
  place_the_rest(plan);
  return plan;
}

// What is the same for all blocks: constants for layers that are fixed or that no output depends
// on, and room for outputs that are not kept.
void PlaneEngine::place_the_rest(Plan& plan) {
  const Table& table = *plan.table;
  const LayerBits inputs = table.rule ? table.rule->inputs : table.shape.inputs;
  for (std::size_t layer = 0; layer < kPlanes; ++layer) {
    if (has(inputs & ~plan.options.fixed, layer)) {
      plan.fetched.push_back(static_cast<std::uint8_t>(layer));
    } else {
      const bool bit = has(plan.options.fixed & plan.options.fixed_bits, layer);
      places_[layer] = constants_[bit ? 1 : 0].words.data();
    }
    places_[PlaneRule::kFirstOutput + layer] = rooms_[PlaneRule::kFirstOutput + layer].words.data();
    if (has(plan.made, layer)) plan.worked_out.push_back(static_cast<std::uint8_t>(layer));
  }
}

void PlaneEngine::place_block(const Plan& plan, std::size_t block) {
  for (const std::size_t layer : plan.fetched) {
    const Word* const input = planes_.fetch(layer, block, rooms_[layer].words.data());
    places_[layer] = const_cast<Word*>(input);  // nothing writes to an input
  }
  for (const std::size_t layer : plan.worked_out) {
    if (const auto& plane = plan.planes[layer]) {
      places_[PlaneRule::kFirstOutput + layer] = planes_.block_of(*plane, block);
    }
  }
}

void PlaneEngine::work(Plan& plan, std::size_t block) {
  place_block(plan, block);
  const Table& table = *plan.table;
  Word* const* const out = places_.data() + PlaneRule::kFirstOutput;
  if (table.rule) {
    kernels_->run_ops(table.rule->ops.data(), table.rule->ops.size(), places_.data());
  } else {
    kernels_->apply_table(places_.data(), table.entries.data(), out);
  }
  for (const std::size_t layer : plan.worked_out) {
    // A layer that the table keeps becomes what the table was told instead of it.
    if (has(table.shape.kept, layer)) std::copy_n(places_[layer], kBlockWords, out[layer]);
    if (plan.options.counting == Counting::Outputs) {
      plan.ones[layer] += kernels_->count_ones(out[layer], planes_.words_of_block());
    }
  }
}

PlaneCounts PlaneEngine::counts_of(const Plan& plan) {
  if (plan.options.counting == Counting::Nothing) return {};
  if (plan.options.counting == Counting::Sites) return population();
  PlaneCounts counts{};
  for (std::size_t layer = 0; layer < kPlanes; ++layer) {
    counts[layer] =
        has(plan.kept, layer) ? planes_.population(layer) : plan.ones[plan.source[layer]];
  }
  return counts;
}

void PlaneEngine::finish(const Plan& plan) {
  for (std::size_t layer = 0; layer < kPlanes; ++layer) {
    if (has(plan.kept, layer) || !has(plan.options.written, layer)) continue;
    const std::size_t source = plan.source[layer];
    planes_.show(layer, *plan.planes[source]);
    if (plan.options.counting == Counting::Outputs) {
      planes_.note_population(*plan.planes[source], plan.ones[source]);
    }
  }
  planes_.release_unused();
}

std::optional<std::size_t> PlaneEngine::compiled_ops(std::size_t bank) const {
  if (bank >= kBanks || !tables_[bank].rule) return std::nullopt;
  return tables_[bank].rule->ops.size();
}

PlaneCounts PlaneEngine::population() {
  PlaneCounts counts{};
  for (std::size_t layer = 0; layer < kPlanes; ++layer) counts[layer] = planes_.population(layer);
  return counts;
}

}  // namespace thimble::sim::cam
