#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "drivers/cambus/cam_program.hpp"
#include "drivers/cambus/step_list_check.hpp"
#include "sim/model/cam/step_interface.hpp"
#include "tests/unit/cambus/hand_list.hpp"

namespace thimble::cambus::test {

// Cells of a whole space, x first: 16 bits each.
using Cells = std::vector<std::uint16_t>;

// How a board and a space on it are laid out.
struct Layout {
  Axes log2_modules;
  Axes log2_cells;
  Division division;
};

inline std::string to_string(const Layout& layout) {
  const char* const names[] = {"mesh", "strip-x", "strip-y", "strip-z"};
  std::string text;
  for (const int modules : layout.log2_modules) text += std::to_string(1 << modules);
  return text + " " + names[static_cast<int>(layout.division)];
}
inline void PrintTo(const Layout& layout, std::ostream* out) { *out << to_string(layout); }

// A simulated board that is only reached through step lists, each of them checked.
class CamBench {
 public:
  explicit CamBench(const Layout& layout, int log2_sites = 0)
      : space_(space_of(layout, log2_sites)),
        machine_({{modules(layout, 0), modules(layout, 1), modules(layout, 2)},
                  space_.board().log2_sites}),
        log2_cells_(layout.log2_cells) {
    CamProgram program(space_);
    program.number_modules();
    program.set_up();
    play(program);
  }

  // Plays what has been put into the program; what it reads is looked for with words_of().
  void play(CamProgram& program) { play(program.finish()); }
  void play(const StepList& list) {
    const auto summary = check_step_list(
        list.view(), list.head,
        {.module_sites = 1U << space_.board().log2_sites, .has_sync = true});  // if a test likes
    ASSERT_TRUE(summary) << summary.error().message;
    window_ = HandWindow(list.base + list.bytes.size());
    std::copy(list.bytes.begin(), list.bytes.end(), window_.bytes().begin() + list.base);
    sim::cam::StepInterface interface(machine_, bus::SharedWords(window_.words()));
    interface.write_next_list(list.head);
    ASSERT_TRUE(interface.run(summary->steps));
    ASSERT_EQ(interface.state(), sim::cam::StepInterface::State::Waiting);
    ASSERT_EQ(machine_.counters().disturbed_scans, 0U);
  }
  std::vector<std::uint16_t> words_of(const ReadSlot& slot) {
    std::vector<std::uint16_t> words(slot.words);
    for (std::size_t k = 0; k < words.size(); ++k) {
      const std::size_t at = slot.offset + 2 * k;
      words[k] = static_cast<std::uint16_t>(window_.bytes()[at] | window_.bytes()[at + 1] << 8);
    }
    return words;
  }

  void put(const Cells& cells) {
    std::vector<std::vector<std::uint16_t>> sectors(
        static_cast<std::size_t>(space_.modules()),
        std::vector<std::uint16_t>(std::size_t{1} << space_.log2_sector_sites()));
    for_each_cell([&](std::size_t i, const CellPlace& place) {
      sectors[static_cast<std::size_t>(place.module)][place.site] = cells[i];
    });
    for (int module = 0; module < space_.modules(); ++module) {
      CamProgram program(space_);
      program.write_sites(module, sectors[static_cast<std::size_t>(module)]);
      play(program);
    }
  }
  Cells get() {
    Cells cells(cell_count());
    for (int module = 0; module < space_.modules(); ++module) {
      CamProgram program(space_);
      const ReadSlot slot = program.read_sites(module);
      play(program);
      const auto sites = words_of(slot);
      for_each_cell([&](std::size_t i, const CellPlace& place) {
        if (place.module == module) cells[i] = sites[place.site];
      });
    }
    return cells;
  }
  // The rule for all 65,536 cells, and at once in force.
  void load(const std::function<std::uint32_t(std::uint32_t)>& rule) {
    LookupTable table(kTableEntries);
    for (std::size_t n = 0; n < table.size(); ++n) {
      table[n] = static_cast<std::uint16_t>(rule(static_cast<std::uint32_t>(n)));
    }
    CamProgram program(space_);
    program.load_table(table);
    program.run({.is_scan = false, .swaps_tables = true});
    play(program);
  }
  void step(const std::vector<LayerKick>& kicks, int times = 1) {
    CamProgram program(space_);
    for (int i = 0; i < times; ++i) {
      const auto kicked = program.kick(kicks);
      ASSERT_TRUE(kicked) << kicked.error().message;
      program.run();
    }
    play(program);
  }

  std::size_t cell_count() const {
    return std::size_t{1} << (log2_cells_[0] + log2_cells_[1] + log2_cells_[2]);
  }
  Axes cell_at(std::size_t i) const {
    Axes at{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      at[axis] = static_cast<int>(i & ((std::size_t{1} << log2_cells_[axis]) - 1));
      i >>= log2_cells_[axis];
    }
    return at;
  }
  // The index of a cell, around the edges.
  std::size_t index_of(const Axes& at) const {
    std::size_t index = 0;
    for (std::size_t axis = 3; axis-- > 0;) {
      const int length = 1 << log2_cells_[axis];
      index = (index << log2_cells_[axis]) | static_cast<std::size_t>(at[axis] & (length - 1));
    }
    return index;
  }
  const CamSpace& space() const { return space_; }
  sim::cam::CamMachine& machine() { return machine_; }

 private:
  static std::size_t modules(const Layout& layout, std::size_t axis) {
    return std::size_t{1} << layout.log2_modules[axis];
  }
  // A module has as many sites as it needs, so that a test's memory is small.
  static CamSpace space_of(const Layout& layout, int log2_sites) {
    const Axes& m = layout.log2_modules;
    const Axes& c = layout.log2_cells;
    const int needed = c[0] + c[1] + c[2] - m[0] - m[1] - m[2];
    const BoardShape board{m, std::max(log2_sites, needed)};
    return CamSpace::make(board, layout.log2_cells, layout.division).value();
  }
  void for_each_cell(const std::function<void(std::size_t, const CellPlace&)>& what) const {
    for (std::size_t i = 0; i < cell_count(); ++i) what(i, space_.place_of(cell_at(i)));
  }

  CamSpace space_;
  sim::cam::CamMachine machine_;
  Axes log2_cells_;
  HandWindow window_{0};
};

inline Cells random_cells(std::size_t count, std::uint16_t mask, std::mt19937& random) {
  Cells cells(count);
  for (auto& cell : cells) cell = static_cast<std::uint16_t>(random() & mask);
  return cells;
}

inline std::uint32_t identity(std::uint32_t cell) { return cell; }

}  // namespace thimble::cambus::test
