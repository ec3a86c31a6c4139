#include "sim/model/cam/engine/plane_engine.hpp"

#include <algorithm>
#include <numeric>
#include <string>
#include <system_error>
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

// Whether a scan is worth calling others. SOURCE: measured (bench cam_engine): a block takes 3 us
// by a table and 7 ns for each operation; a thread that sleeps is there after some 10 us.
constexpr std::size_t kBlocksWorthSharing = 16;
constexpr std::size_t kOpsWorthSharing = 8192;

bool is_worth_sharing(std::size_t blocks, const std::optional<PlaneRule>& rule) {
  return rule ? rule->ops.size() * blocks >= kOpsWorthSharing : blocks >= kBlocksWorthSharing;
}

// Sites of the last block that a space smaller than a block does not have.
struct alignas(64) SiteBlock {
  std::array<std::uint16_t, kBlockSites> sites{};
};

}  // namespace

Result<std::unique_ptr<PlaneEngine>> PlaneEngine::make(const SiteSpace& space, TablePath path,
                                                       const VectorKernels& kernels,
                                                       std::size_t threads) {
  if (Result<void> checked = check_space(space); !checked) return tl::unexpected(checked.error());
  if (threads < 1 || threads > kMostThreads) {
    return fail(Errc::InvalidArgument,
                "an engine has 1 to " + std::to_string(kMostThreads) + " threads");
  }
  try {
    return std::unique_ptr<PlaneEngine>(new PlaneEngine(space, path, kernels, threads));
  } catch (const std::system_error& error) {
    return fail(Errc::System, std::string("an engine's threads: ") + error.what());
  }
}

PlaneEngine::PlaneEngine(const SiteSpace& space, TablePath path, const VectorKernels& kernels,
                         std::size_t threads)
    : path_(path), kernels_(&kernels), planes_(space, kernels), hands_(threads), team_(threads) {
  for (Hand& hand : hands_) {
    hand.rooms.resize(PlaneRule::kFirstRoom);
    hand.places.resize(PlaneRule::kFirstRoom);
  }
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
      in[layer] = planes_.fetch(layer, block, hands_[0].rooms[layer].words.data());
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
    const Word* const from = planes_.fetch(layer, block, hands_[0].rooms[layer].words.data());
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
    for (Hand& hand : hands_) {
      auto& rooms = hand.rooms;
      rooms.resize(std::max(rooms.size(), PlaneRule::kFirstRoom + table.rule->rooms));
      hand.places.resize(rooms.size());
      for (std::size_t i = PlaneRule::kFirstRoom; i < rooms.size(); ++i) {
        hand.places[i] = rooms[i].words.data();
      }
    }
  }
  tables_[bank] = std::move(table);
  return {};
}

Result<PlaneCounts> PlaneEngine::step(std::span<const PlaneKick> kicks,
                                      const StepOptions& options) {
  if (options.bank >= kBanks) return fail(Errc::InvalidArgument, "there are banks 0 and 1");
  planes_.kick(kicks);
  const Plan plan = make_plan(options);
  work_all(plan);
  const PlaneCounts ones = made_ones();
  const PlaneCounts counts = counts_of(plan, ones);
  finish(plan, ones);
  return counts;
}

void PlaneEngine::work_all(const Plan& plan) {
  for (Hand& hand : hands_) hand.ones = {};
  if (plan.made == 0) return;
  const bool is_shared = is_worth_sharing(planes_.blocks(), plan.table->rule);
  for (Hand& hand : std::span(hands_).first(is_shared ? hands_.size() : 1)) {
    place_the_rest(plan, hand);
  }
  const auto work_here = [&](std::size_t member, std::size_t block) {
    work(plan, block, hands_[member]);
  };
  if (is_shared) return team_.run(planes_.blocks(), work_here);
  for (std::size_t block = 0; block < planes_.blocks(); ++block) work_here(0, block);
}

PlaneCounts PlaneEngine::made_ones() const {
  PlaneCounts ones{};
  for (const Hand& hand : hands_) {
    for (std::size_t layer = 0; layer < kPlanes; ++layer) ones[layer] += hand.ones[layer];
  }
  return ones;
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
  choose_layers(plan);
  return plan;
}

void PlaneEngine::choose_layers(Plan& plan) const {
  const Table& table = *plan.table;
  const LayerBits inputs = table.rule ? table.rule->inputs : table.shape.inputs;
  for (std::size_t layer = 0; layer < kPlanes; ++layer) {
    const auto number = static_cast<std::uint8_t>(layer);
    if (has(inputs & ~plan.options.fixed, layer)) plan.fetched.push_back(number);
    if (has(plan.made, layer)) plan.worked_out.push_back(number);
  }
}

// What is the same for all blocks: constants for layers that are fixed or that no output depends
// on, and room for outputs that are not kept.
void PlaneEngine::place_the_rest(const Plan& plan, Hand& hand) {
  for (std::size_t layer = 0; layer < kPlanes; ++layer) {
    const bool bit = has(plan.options.fixed & plan.options.fixed_bits, layer);
    hand.places[layer] = constants_[bit ? 1 : 0].words.data();
    const std::size_t output = PlaneRule::kFirstOutput + layer;
    hand.places[output] = hand.rooms[output].words.data();
  }
}

void PlaneEngine::place_block(const Plan& plan, std::size_t block, Hand& hand) {
  for (const std::size_t layer : plan.fetched) {
    const Word* const input = planes_.fetch(layer, block, hand.rooms[layer].words.data());
    hand.places[layer] = const_cast<Word*>(input);  // nothing writes to an input
  }
  for (const std::size_t layer : plan.worked_out) {
    if (const auto& plane = plan.planes[layer]) {
      hand.places[PlaneRule::kFirstOutput + layer] = planes_.block_of(*plane, block);
    }
  }
}

void PlaneEngine::work(const Plan& plan, std::size_t block, Hand& hand) {
  place_block(plan, block, hand);
  const Table& table = *plan.table;
  const auto& places = hand.places;
  Word* const* const out = places.data() + PlaneRule::kFirstOutput;
  if (table.rule) {
    kernels_->run_ops(table.rule->ops.data(), table.rule->ops.size(), places.data());
  } else {
    kernels_->apply_table(places.data(), table.entries.data(), out);
  }
  for (const std::size_t layer : plan.worked_out) {
    // A layer that the table keeps becomes what the table was told instead of it.
    if (has(table.shape.kept, layer)) std::copy_n(places[layer], kBlockWords, out[layer]);
    if (plan.options.counting == Counting::Outputs) {
      hand.ones[layer] += kernels_->count_ones(out[layer], planes_.words_of_block());
    }
  }
}

PlaneCounts PlaneEngine::counts_of(const Plan& plan, const PlaneCounts& ones) {
  if (plan.options.counting == Counting::Nothing) return {};
  if (plan.options.counting == Counting::Sites) return population();
  PlaneCounts counts{};
  for (std::size_t layer = 0; layer < kPlanes; ++layer) {
    counts[layer] = has(plan.kept, layer) ? planes_.population(layer) : ones[plan.source[layer]];
  }
  return counts;
}

void PlaneEngine::finish(const Plan& plan, const PlaneCounts& ones) {
  for (std::size_t layer = 0; layer < kPlanes; ++layer) {
    if (has(plan.kept, layer) || !has(plan.options.written, layer)) continue;
    const std::size_t source = plan.source[layer];
    planes_.show(layer, *plan.planes[source]);
    if (plan.options.counting == Counting::Outputs) {
      planes_.note_population(*plan.planes[source], ones[source]);
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
