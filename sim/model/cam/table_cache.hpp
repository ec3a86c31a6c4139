#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sim/model/cam/engine/plane_rule.hpp"
#include "sim/model/cam/engine/vector_kernels.hpp"

namespace thimble::sim::cam {

// A table and the operations on planes that do the same, where those are faster.
struct PreparedTable {
  std::vector<std::uint16_t> entries{};
  TableShape shape{};
  std::optional<PlaneRule> rule{};  // checked against all entries
};

// The tables that were in force lately: preparing one takes milliseconds, finding it again
// microseconds.
// Thread: one at a time.
class TableCache {
 public:
  // SOURCE: ours; a program has two tables in a module, and one of pieces four by turns.
  static constexpr std::size_t kTables = 16;

  explicit TableCache(const VectorKernels& kernels) noexcept : kernels_(&kernels) {}
  // Of 65,536 entries.
  [[nodiscard]] std::shared_ptr<const PreparedTable> prepare(
      std::span<const std::uint16_t> entries);

 private:
  const VectorKernels* kernels_;
  std::list<std::shared_ptr<const PreparedTable>> tables_;  // the last that was asked for first
};

}  // namespace thimble::sim::cam
