#include "sim/model/cam/engine/plane_rule.hpp"

#include <algorithm>
#include <utility>

namespace thimble::sim::cam {
namespace {

using Code = PlaneOp::Code;
using Literal = BitFunctions::Literal;

constexpr std::size_t kEntries = std::size_t{1} << kPlanes;

// Turns nodes into operations, each behind those that it needs. What several nodes need is stored,
// and its room used again when the last of them has had it.
class OpWriter {
 public:
  explicit OpWriter(const BitFunctions& functions)
      : functions_(functions), uses_(functions.size(), 0), place_(functions.size(), kNowhere) {}

  void write(std::span<const std::pair<std::size_t, Literal>> outputs);
  [[nodiscard]] PlaneRule take() { return std::move(rule_); }

 private:
  static constexpr std::uint16_t kNowhere = 0xffff;

  void count_uses(std::size_t node);
  void compute(std::size_t node);
  void load(std::size_t node);
  void choose(std::uint16_t variable, std::size_t high, bool is_not, std::size_t low);
  [[nodiscard]] bool is_variable(std::size_t node) const;
  [[nodiscard]] bool is_at_hand(std::size_t node) const {
    return place_[node] != kNowhere || is_variable(node);
  }
  // The block of a node that is at hand; one use of it is over.
  [[nodiscard]] std::uint16_t use(std::size_t node);
  void put(Code code, std::uint16_t a = 0, std::uint16_t b = 0) {
    rule_.ops.push_back({code, a, b});
  }
  std::uint16_t input(std::uint8_t variable) {
    rule_.inputs = static_cast<LayerBits>(rule_.inputs | 1U << variable);
    return variable;
  }
  void store(std::size_t node);

  const BitFunctions& functions_;
  std::vector<std::uint32_t> uses_;   // still to come
  std::vector<std::uint16_t> place_;  // the block that has it
  std::vector<std::uint16_t> free_{};
  PlaneRule rule_{};
};

void OpWriter::write(std::span<const std::pair<std::size_t, Literal>> outputs) {
  for (const auto& [layer, literal] : outputs) count_uses(BitFunctions::index_of(literal));
  for (const auto& [layer, literal] : outputs) {
    const std::size_t node = BitFunctions::index_of(literal);
    if (node == 0) {
      put(Code::Zero);
    } else {
      load(node);
    }
    const auto block = static_cast<std::uint16_t>(PlaneRule::kFirstOutput + layer);
    put(BitFunctions::is_complement(literal) ? Code::StoreNot : Code::Store, block);
  }
}

void OpWriter::count_uses(std::size_t node) {
  if (node == 0 || uses_[node]++ > 0) return;
  const std::size_t high = BitFunctions::index_of(functions_.node(node).high);
  const std::size_t low = BitFunctions::index_of(functions_.node(node).low);
  count_uses(low);
  if (high != low) count_uses(high);
}

bool OpWriter::is_variable(std::size_t node) const {
  const auto& what = functions_.node(node);
  return node != 0 && what.high == BitFunctions::kTrue && what.low == BitFunctions::kFalse;
}

std::uint16_t OpWriter::use(std::size_t node) {
  if (is_variable(node)) return input(functions_.node(node).variable);
  const std::uint16_t block = place_[node];
  if (--uses_[node] == 0) {
    free_.push_back(block);
    place_[node] = kNowhere;
  }
  return block;
}

void OpWriter::store(std::size_t node) {
  if (free_.empty()) {
    free_.push_back(static_cast<std::uint16_t>(PlaneRule::kFirstRoom + rule_.rooms++));
  }
  place_[node] = free_.back();
  free_.pop_back();
  put(Code::Store, place_[node]);
}

void OpWriter::load(std::size_t node) {
  if (is_at_hand(node)) {
    put(Code::Load, use(node));
  } else {
    compute(node);
  }
}

// Leaves the node in the accumulator, and stored when there is another use to come.
void OpWriter::compute(std::size_t number) {
  const BitFunctions::Node& node = functions_.node(number);
  const std::size_t high = BitFunctions::index_of(node.high);
  const std::size_t low = BitFunctions::index_of(node.low);
  const std::uint16_t variable = input(node.variable);
  const bool is_not = BitFunctions::is_complement(node.high);
  if (high == low) {
    load(low);
    put(Code::Xor, variable);
  } else if (low == 0) {
    load(high);
    put(is_not ? Code::NotAnd : Code::And, variable);
  } else if (high == 0) {
    load(low);
    put(is_not ? Code::Or : Code::AndNot, variable);
  } else {
    choose(variable, high, is_not, low);
  }
  if (--uses_[number] > 0) store(number);
}

// What is not at hand comes last, so that it is in the accumulator when it is wanted.
void OpWriter::choose(std::uint16_t variable, std::size_t high, bool is_not, std::size_t low) {
  if (!is_at_hand(low) && !is_at_hand(high)) {
    compute(low);
    ++uses_[low];  // it has not been had yet
    if (place_[low] == kNowhere) store(low);
  }
  if (is_at_hand(low)) {
    load(high);
    put(is_not ? Code::MuxNotHigh : Code::MuxHigh, variable, use(low));
  } else {
    load(low);
    put(is_not ? Code::MuxLowNot : Code::MuxLow, variable, use(high));
  }
}

// Bits of all values that a site can have, 4096 of them to a block: of layer `layer`, word `word`.
Word value_bits(std::size_t block, std::size_t word, std::size_t layer) {
  constexpr std::array<Word, 6> kWithinWord{0xaaaaaaaaaaaaaaaa, 0xcccccccccccccccc,
                                            0xf0f0f0f0f0f0f0f0, 0xff00ff00ff00ff00,
                                            0xffff0000ffff0000, 0xffffffff00000000};
  if (layer < kWithinWord.size()) return kWithinWord[layer];
  const std::size_t value = block * kBlockSites + word * kWordSites;
  return (value >> layer & 1) != 0 ? ~Word{0} : 0;
}

std::optional<PlaneRule> compile_in_order(std::span<const std::uint16_t> table,
                                          std::span<const std::uint8_t> order, LayerBits kept,
                                          std::size_t most_ops) {
  BitFunctions functions(order, most_ops + 1);
  std::array<std::uint8_t, kPlanes> same_as{};
  std::vector<std::pair<std::size_t, Literal>> outputs;
  for (std::size_t layer = 0; layer < kPlanes; ++layer) {
    same_as[layer] = static_cast<std::uint8_t>(layer);
    if ((kept >> layer & 1) != 0) continue;
    const auto literal = functions.add(table, static_cast<unsigned>(layer));
    if (!literal) return std::nullopt;
    const auto known = std::find_if(outputs.begin(), outputs.end(),
                                    [&](const auto& output) { return output.second == *literal; });
    if (known == outputs.end()) {
      outputs.emplace_back(layer, *literal);
    } else {
      same_as[layer] = static_cast<std::uint8_t>(known->first);
    }
  }
  OpWriter writer(functions);
  writer.write(outputs);
  PlaneRule rule = writer.take();
  rule.same_as = same_as;
  if (rule.ops.size() > most_ops) return std::nullopt;
  return rule;
}

}  // namespace

TableShape shape_of(std::span<const std::uint16_t> table) {
  std::uint32_t changed = 0;
  for (std::uint32_t value = 0; value < kEntries; ++value) changed |= table[value] ^ value;
  TableShape shape;
  shape.kept = static_cast<LayerBits>(~changed);
  for (std::size_t layer = 0; layer < kPlanes; ++layer) {
    const std::size_t bit = std::size_t{1} << layer;
    std::uint32_t differs = 0;
    for (std::size_t value = 0; value < kEntries; ++value) {
      differs |= std::uint32_t{table[value]} ^ table[value ^ bit];
    }
    if ((differs & changed) != 0) shape.inputs = static_cast<LayerBits>(shape.inputs | bit);
  }
  return shape;
}

std::optional<PlaneRule> compile_rule(std::span<const std::uint16_t> table, std::size_t most_ops) {
  const TableShape shape = shape_of(table);
  std::vector<std::uint8_t> order;
  for (std::size_t layer = 0; layer < kPlanes; ++layer) {
    if ((shape.inputs >> layer & 1) != 0) order.push_back(static_cast<std::uint8_t>(layer));
  }
  auto best = compile_in_order(table, order, shape.kept, most_ops);
  std::reverse(order.begin(), order.end());
  auto other = compile_in_order(table, order, shape.kept, best ? best->ops.size() : most_ops);
  return other ? std::move(other) : std::move(best);
}

bool does_as_table(const PlaneRule& rule, std::span<const std::uint16_t> table,
                   const VectorKernels& kernels) {
  using Block = std::array<Word, kBlockWords>;
  const LayerBits kept = shape_of(table).kept;
  std::vector<Block> storage(PlaneRule::kFirstRoom + rule.rooms);
  std::vector<Word*> blocks(storage.size());
  std::transform(storage.begin(), storage.end(), blocks.begin(),
                 [](Block& block) { return block.data(); });
  std::array<const Word*, kPlanes> outputs{};
  for (std::size_t layer = 0; layer < kPlanes; ++layer) {
    const bool is_kept = (kept >> layer & 1) != 0;
    outputs[layer] = blocks[is_kept ? layer : PlaneRule::kFirstOutput + rule.same_as[layer]];
  }
  std::array<std::uint16_t, kBlockSites> sites{};
  for (std::size_t block = 0; block < kEntries / kBlockSites; ++block) {
    for (std::size_t layer = 0; layer < kPlanes; ++layer) {
      for (std::size_t word = 0; word < kBlockWords; ++word) {
        storage[layer][word] = value_bits(block, word, layer);
      }
    }
    kernels.run_ops(rule.ops.data(), rule.ops.size(), blocks.data());
    kernels.to_sites(outputs.data(), sites.data());
    const auto expected = table.subspan(block * kBlockSites, kBlockSites);
    if (!std::equal(sites.begin(), sites.end(), expected.begin())) return false;
  }
  return true;
}

}  // namespace thimble::sim::cam
