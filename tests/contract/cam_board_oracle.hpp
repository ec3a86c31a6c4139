#pragma once

#include <algorithm>
#include <memory>
#include <random>
#include <utility>

#include "hal/device/cam_board.hpp"

namespace thimble::test {

// What programs do, on one array whose axes wrap: no modules, no registers, no offsets.
class CamBoardOracle {
 public:
  explicit CamBoardOracle(const CamGeometry& space) : space_(space), cells_(space.cells()) {}

  // Nothing is left open: cells and both tables.
  [[nodiscard]] CamSteps first_program(std::mt19937& random) {
    using namespace cam_step;
    const CamSteps steps{LoadTable{random_words(random, kCamTableEntries)},
                         Run{{.is_scan = false, .swaps_tables = true}},
                         LoadTable{random_words(random, kCamTableEntries)},
                         WriteCells{random_words(random, cells_.size())},
                         Run{{.is_scan = false, .takes_counts = true}}};
    static_cast<void>(play(steps));
    return steps;
  }

  CamAnswer play(const CamSteps& steps) {
    answer_ = {};
    for (const CamStep& step : steps) std::visit([this](const auto& it) { take(it); }, step);
    return std::exchange(answer_, {});
  }

  static std::shared_ptr<const std::vector<std::uint16_t>> random_words(std::mt19937& random,
                                                                        std::size_t count) {
    std::vector<std::uint16_t> words(count);
    for (auto& word : words) word = static_cast<std::uint16_t>(random());
    return std::make_shared<const std::vector<std::uint16_t>>(std::move(words));
  }

 private:
  void take(const cam_step::Kick& it) {
    kick_ = it;
    is_waiting_ = true;
  }
  void take(const cam_step::LoadTable& it) { other_ = *it.table; }
  void take(const cam_step::Fix& it) { fix_ = it; }
  void take(const cam_step::Count& it) { count_ = it; }
  void take(const cam_step::Within&) {}  // elsewhere nothing would change
  void take(const cam_step::ReadCounts&) { answer_.counts.push_back(latched_); }
  void take(const cam_step::WriteCells& it) {
    cells_ = *it.cells;
    kick_ = {};
    is_waiting_ = false;
  }
  void take(const cam_step::ReadCells&) {
    answer_.cells.push_back(cells_);
    kick_ = {};
    is_waiting_ = false;
  }
  void take(const cam_step::Show&) {
    kick_ = {};
    is_waiting_ = false;
  }
  void take(const cam_step::Run& it) {
    if (it.options.takes_counts) latched_ = std::exchange(counts_, {});
    if (it.options.swaps_tables) std::swap(table_, other_);
    if (!it.options.is_scan) return;
    if (!is_waiting_ && !it.options.repeats_kick) kick_ = {};
    is_waiting_ = false;
    scan();
  }

  void scan() {
    const CamCells moved = move();
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const auto seen =
          static_cast<std::uint16_t>((moved[i] & ~fix_.layers) | (fix_.bits & fix_.layers));
      cells_[i] = table_[seen];
      if (count_.what != CamEvents::None) {
        count(count_.what == CamEvents::Site ? moved[i] : cells_[i]);
      }
    }
  }
  CamCells move() const {
    CamCells moved(cells_.size());
    for (std::size_t layer = 0; layer < kCamLayers; ++layer) {
      CamAxes by{};
      for (const CamKick& kick : kick_.kicks) {
        if (((kick.layers >> layer) & 1U) != 0) by = kick.cells;
      }
      for (std::size_t i = 0; i < cells_.size(); ++i) {
        moved[away(i, by)] |= static_cast<std::uint16_t>(cells_[i] & (1U << layer));
      }
    }
    return moved;
  }
  // The index of the cell so far from another one.
  std::size_t away(std::size_t index, const CamAxes& by) const {
    std::size_t result = 0;
    unsigned shift = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto bits = static_cast<unsigned>(space_.log2_cells[axis]);
      const std::size_t mask = (std::size_t{1} << bits) - 1;
      const std::size_t at = index & mask;
      result |= ((at + static_cast<std::size_t>(by[axis])) & mask) << shift;
      index >>= bits;
      shift += bits;
    }
    return result;
  }
  void count(std::uint16_t bits) {
    bits &= count_.layers;
    for (std::size_t layer = 0; layer < kCamLayers; ++layer) counts_[layer] += (bits >> layer) & 1U;
  }

  CamGeometry space_;
  CamCells cells_;
  CamTable table_ = CamTable(kCamTableEntries);
  CamTable other_ = table_;
  cam_step::Kick kick_;
  bool is_waiting_{false};  // for its scan
  cam_step::Fix fix_;
  cam_step::Count count_;
  CamCounts counts_{};
  CamCounts latched_{};
  CamAnswer answer_;
};

// Steps that any board takes: kicks of up to two cells, each with its scan.
inline CamSteps random_steps(std::mt19937& random, const CamGeometry& space) {
  using namespace cam_step;
  const auto below = [&](unsigned n) { return static_cast<unsigned>(random() % n); };
  const auto few = [&] { return static_cast<int>(below(5)) - 2; };
  CamSteps steps;
  for (unsigned n = 1 + below(6); n > 0; --n) {
    const unsigned what = below(8);
    if (what == 0)
      steps.emplace_back(LoadTable{CamBoardOracle::random_words(random, kCamTableEntries)});
    if (what == 1)
      steps.emplace_back(
          Fix{static_cast<CamLayers>(random()), static_cast<std::uint16_t>(random())});
    if (what == 2) {
      const auto layers = static_cast<CamLayers>(below(2) == 0 ? 0xffff : below(0x10000));
      steps.emplace_back(Count{static_cast<CamEvents>(below(3)), layers});
    }
    if (what == 3) {
      steps.emplace_back(WriteCells{CamBoardOracle::random_words(random, space.cells())});
    }
    // A board need not show rows that it divides.
    const bool has_rows =
        space.division == CamDivision::StripY || space.division == CamDivision::StripZ;
    if (what == 6 && has_rows) steps.emplace_back(Show{static_cast<int>(below(2))});
    const bool is_kicked = what == 4 || what == 5;
    if (is_kicked) {
      Kick kick;
      for (unsigned k = below(4); k > 0; --k) {
        // Two modules may share an axis of two cells.
        kick.kicks.push_back(
            {static_cast<CamLayers>(random()), {few(), few(), static_cast<int>(below(3)) - 1}});
      }
      steps.emplace_back(kick);
    }
    steps.emplace_back(Run{{.takes_counts = below(2) == 0,
                            .swaps_tables = below(4) == 0,
                            .repeats_kick = !is_kicked && below(4) == 0}});
    if (below(3) == 0) steps.emplace_back(Run{{.is_scan = false, .takes_counts = true}});
    steps.emplace_back(ReadCounts{});
  }
  steps.emplace_back(ReadCells{});
  return steps;
}

}  // namespace thimble::test
