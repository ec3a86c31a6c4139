#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <ostream>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "sim/model/cam/engine/plane_engine.hpp"

namespace thimble::sim::cam {

namespace test {

using Cells = std::vector<std::uint16_t>;
using Table = std::vector<std::uint16_t>;

// What a step does, site by site.
struct PlainSpace {
  SiteSpace space;
  Cells cells;

  [[nodiscard]] std::size_t index_of(std::array<int, 3> at) const {
    std::size_t index = 0;
    for (std::size_t axis = 3; axis-- > 0;) {
      const int log2 = space.log2_cells[axis];
      index = index << log2 | static_cast<std::size_t>(at[axis] & ((1 << log2) - 1));
    }
    return index;
  }
  [[nodiscard]] std::array<int, 3> place_of(std::size_t index) const {
    std::array<int, 3> at{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      at[axis] = static_cast<int>(index & ((std::size_t{1} << space.log2_cells[axis]) - 1));
      index >>= space.log2_cells[axis];
    }
    return at;
  }

  PlaneCounts step(const Table& table, std::span<const PlaneKick> kicks,
                   const StepOptions& options) {
    Cells moved(cells.size());
    for (unsigned layer = 0; layer < 16; ++layer) {
      std::array<int, 3> by{};
      for (const PlaneKick& kick : kicks) {
        if ((kick.layers >> layer & 1) != 0) by = kick.cells;
      }
      for (std::size_t i = 0; i < cells.size(); ++i) {
        const auto at = place_of(i);
        const std::size_t to = index_of({at[0] + by[0], at[1] + by[1], at[2] + by[2]});
        moved[to] = static_cast<std::uint16_t>(moved[to] | (cells[i] & 1U << layer));
      }
    }
    PlaneCounts counts{};
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::uint32_t told =
          (moved[i] & ~std::uint32_t{options.fixed}) | (options.fixed_bits & options.fixed);
      const std::uint32_t output = table[told];
      const std::uint32_t counted = options.counting == Counting::Sites ? moved[i] : output;
      for (std::size_t layer = 0; layer < 16; ++layer) {
        if (options.counting != Counting::Nothing) counts[layer] += counted >> layer & 1;
      }
      cells[i] = static_cast<std::uint16_t>((output & options.written) |
                                            (moved[i] & ~std::uint32_t{options.written}));
    }
    return counts;
  }
};

inline Cells random_cells(std::size_t count, std::mt19937& random) {
  Cells cells(count);
  for (auto& cell : cells) cell = static_cast<std::uint16_t>(random());
  return cells;
}

inline Table table_of(const std::function<std::uint32_t(std::uint32_t)>& rule) {
  Table table(65536);
  for (std::uint32_t value = 0; value < table.size(); ++value) {
    table[value] = static_cast<std::uint16_t>(rule(value));
  }
  return table;
}

inline Table random_table(std::mt19937& random) {
  return table_of([&](std::uint32_t) { return random(); });
}

// Outputs that are random functions of three or four layers each, some of them alike, some the
// layer's own bit: a table that compiles.
inline Table random_small_table(std::mt19937& random) {
  struct Output {
    std::array<unsigned, 4> inputs;
    std::uint32_t values;
    bool is_kept;
  };
  std::array<Output, 16> outputs{};
  for (std::size_t layer = 0; layer < outputs.size(); ++layer) {
    Output& output = outputs[layer];
    for (unsigned& input : output.inputs) input = random() % 16;
    output.values = static_cast<std::uint32_t>(random() & 0xffffU);
    output.is_kept = random() % 4 == 0;
    if (layer > 0 && random() % 4 == 0) output = outputs[layer - 1];
  }
  return table_of([&](std::uint32_t value) {
    std::uint32_t after = 0;
    for (unsigned layer = 0; layer < 16; ++layer) {
      const Output& output = outputs[layer];
      unsigned entry = 0;
      for (unsigned i = 0; i < 4; ++i) entry |= (value >> output.inputs[i] & 1) << i;
      const std::uint32_t bit = output.is_kept ? value >> layer : output.values >> entry;
      after |= (bit & 1) << layer;
    }
    return after;
  });
}

// Each instruction set that this build has; a test skips those that the processor has not.
class EachInstructionSet : public testing::TestWithParam<const VectorKernels*> {
 protected:
  void SetUp() override {
    const auto usable = usable_kernels();
    if (std::find(usable.begin(), usable.end(), GetParam()) == usable.end()) {
      GTEST_SKIP() << "this processor has no " << GetParam()->name;
    }
  }
};

inline auto instruction_sets() {
  const auto built = built_kernels();
  return testing::ValuesIn(std::vector<const VectorKernels*>(built.begin(), built.end()));
}
inline std::string set_name(const testing::TestParamInfo<const VectorKernels*>& info) {
  return info.param->name;
}

}  // namespace test
}  // namespace thimble::sim::cam
