#include "sim/model/cam/engine/bit_functions.hpp"

#include <algorithm>

namespace thimble::sim::cam {
std::size_t BitFunctions::Hash::operator()(const Node& node) const noexcept {
  std::uint64_t mixed = node.variable + (std::uint64_t{node.high} << 8);
  mixed = (mixed ^ std::uint64_t{node.low} << 36) * 0x9e3779b97f4a7c15ULL;
  return static_cast<std::size_t>(mixed ^ mixed >> 29);
}

BitFunctions::BitFunctions(std::span<const std::uint8_t> order, std::size_t most_nodes)
    : order_(order.begin(), order.end()), entries_{0}, most_nodes_(most_nodes) {
  for (const std::uint8_t variable : order_) {
    const std::size_t half = entries_.size();
    for (std::size_t i = 0; i < half; ++i) {
      entries_.push_back(static_cast<std::uint16_t>(entries_[i] | 1U << variable));
    }
  }
}

std::optional<BitFunctions::Literal> BitFunctions::make(std::uint8_t variable, Literal high,
                                                        Literal low) {
  if (high == low) return low;
  const Literal complement = low & 1;
  const Node wanted{variable, high ^ complement, low ^ complement};
  const auto found = known_.find(wanted);
  if (found != known_.end()) return found->second ^ complement;
  if (nodes_.size() >= most_nodes_) return std::nullopt;
  const auto literal = static_cast<Literal>(2 * nodes_.size());
  nodes_.push_back(wanted);
  known_.emplace(wanted, literal);
  return literal ^ complement;
}

// From the last variable up: a level has a literal for each value of the variables above it.
std::optional<BitFunctions::Literal> BitFunctions::add(std::span<const std::uint16_t> table,
                                                       unsigned bit) {
  std::vector<Literal> level(entries_.size());
  std::transform(entries_.begin(), entries_.end(), level.begin(),
                 [&](std::uint16_t entry) { return Literal{table[entry]} >> bit & 1; });
  for (const std::uint8_t variable : order_) {
    const std::size_t half = level.size() / 2;
    for (std::size_t i = 0; i < half; ++i) {
      const auto made = make(variable, level[2 * i + 1], level[2 * i]);
      if (!made) return std::nullopt;
      level[i] = *made;
    }
    level.resize(half);
  }
  return level.front();
}

}  // namespace thimble::sim::cam
