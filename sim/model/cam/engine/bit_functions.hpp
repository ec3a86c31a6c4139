#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

namespace thimble::sim::cam {

// Functions of 16 bits as one decision diagram that they share: reduced, ordered, with complemented
// edges. A literal is 2 * node, plus 1 for the node's complement.
//
// A node is `variable ? high : low`, and nothing at all for bits that are all 0, so that `low` is
// never a complement. Node 0 is the constant 0.
// Thread: one at a time.
class BitFunctions {
 public:
  using Literal = std::uint32_t;
  static constexpr Literal kFalse = 0;
  static constexpr Literal kTrue = 1;
  struct Node {
    std::uint8_t variable{0};
    Literal high{0};
    Literal low{0};
    bool operator==(const Node&) const = default;
  };

  // `order`: the variables that the functions depend on (at most 16, each once), the one that is
  // asked last first. At most `most_nodes` nodes are made.
  BitFunctions(std::span<const std::uint8_t> order, std::size_t most_nodes);

  // The function that is bit `bit` of each of the 65,536 entries; none when it would take too many
  // nodes. Entries are looked at where all other variables are 0.
  [[nodiscard]] std::optional<Literal> add(std::span<const std::uint16_t> table, unsigned bit);

  [[nodiscard]] const Node& node(std::size_t index) const noexcept { return nodes_[index]; }
  [[nodiscard]] std::size_t size() const noexcept { return nodes_.size(); }  // with the constant
  [[nodiscard]] static std::size_t index_of(Literal literal) noexcept { return literal >> 1; }
  [[nodiscard]] static bool is_complement(Literal literal) noexcept { return (literal & 1) != 0; }

 private:
  [[nodiscard]] std::optional<Literal> make(std::uint8_t variable, Literal high, Literal low);
  struct Hash {
    std::size_t operator()(const Node& node) const noexcept;
  };

  std::vector<std::uint8_t> order_;
  std::vector<std::uint16_t> entries_;  // for each value of the variables in their order
  std::size_t most_nodes_;
  std::vector<Node> nodes_{Node{}};
  std::unordered_map<Node, Literal, Hash> known_{};
};

}  // namespace thimble::sim::cam
