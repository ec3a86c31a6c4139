#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sim/model/cam/cam_torus.hpp"
#include "sim/model/cam/plane_dram.hpp"

namespace thimble::sim::cam {

// What the registers say about a scan, for many sites at a time. Pure, from registers.

// A destination's source register.
struct PlaneSource {
  std::uint8_t select{0};
  std::uint8_t map{0};
};

// Which sites take their bit from the neighbour along one axis.
class Crossing {
 public:
  Crossing() = default;
  // `pointer`, `kick`, `cuts` and flags as in the registers.
  Crossing(std::uint32_t pointer, std::uint32_t kick, std::uint32_t cuts, bool is_minus,
           bool is_most);

  [[nodiscard]] bool is_possible() const noexcept { return is_possible_; }
  // Bit n: site `word` + n.
  [[nodiscard]] Word of(std::uint32_t word) const noexcept {
    const std::uint32_t site = word & mask_;
    const Word borrows = site < kick_ ? ~Word{0} : site == kick_ ? of_equal_ : 0;
    return borrows ^ flip_;
  }

 private:
  std::uint32_t mask_{0};  // the bits of the number that the pointer ends, beyond a word's own
  std::uint32_t kick_{0};
  Word of_equal_{0};
  Word flip_{0};
  bool is_possible_{false};
};

// Which site each visit goes to.
class VisitOrder {
 public:
  // `permuter` as in the register, `index` that of the first visit.
  VisitOrder(const std::array<std::uint32_t, cambus::kAddressBits>& permuter, std::uint32_t index);
  bool operator==(const VisitOrder&) const = default;

  // So many visits take the words one after the other, each at once or the same part of it, and go
  // to no site of such a DRAM twice.
  [[nodiscard]] bool goes_in_words(std::uint64_t visits, int log2_sites) const noexcept;
  // Then: how many sites of each word are visited, and bit n: the one that is n behind its first.
  [[nodiscard]] std::uint64_t sites_of_word() const noexcept { return std::uint64_t{1} << free_; }
  [[nodiscard]] Word visited() const noexcept { return visited_; }
  // A visit is to the same place within its word as the other's, or as its own number says.
  [[nodiscard]] bool is_alike_in_words(const VisitOrder& other) const noexcept;
  [[nodiscard]] bool is_in_turn_in_words() const noexcept;
  // The words from visit `first` on, as goes_in_words() has it.
  [[nodiscard]] SiteWords sites(std::uint64_t first, std::span<std::uint32_t> out) const noexcept;

 private:
  std::array<std::uint32_t, cambus::kAddressBits> permuter_;
  std::uint32_t index_;
  std::uint32_t straight_{0};  // site bits that are the index's own
  std::uint32_t ones_{0};      // and those that are always 1
  std::uint32_t free_{0};      // site bits within a word that are some index bit
  Word visited_{0};
  bool is_straight_{false};  // there are no others
};

struct LayerPlan {
  Placement placement{};
  std::array<Crossing, 3> crossings{};
  std::array<bool, 3> is_minus{};
  std::array<std::uint32_t, kPins> connections{};
  std::uint32_t address_bit{0};
  PlaneSource lut{}, site_data{}, event{}, display{};
  std::size_t order{0};  // of the plan's
};

struct ModulePlan {
  std::array<LayerPlan, cambus::kLayers> layers{};
};

// What a scan's sweeps take, with the refreshes that come between them.
struct ScanPace {
  std::uint64_t sites_a_sweep{1};
  std::uint64_t sweeps{0};
  std::uint64_t clocks_a_sweep{0};
  std::uint64_t sweeps_a_refresh{1};
  std::uint64_t clocks_a_refresh{0};

  [[nodiscard]] std::uint64_t clocks_of_sweep(std::uint64_t number) const noexcept {
    const bool is_refreshed = (number + 1) % sweeps_a_refresh == 0;
    return clocks_a_sweep + (is_refreshed ? clocks_a_refresh : 0);
  }
  [[nodiscard]] std::uint64_t clocks() const noexcept {
    return sweeps * clocks_a_sweep + sweeps / sweeps_a_refresh * clocks_a_refresh;
  }
};

struct ScanPlan {
  std::vector<ModulePlan> modules{};  // as in `which`
  std::vector<VisitOrder> orders{};
  // As the first module's layer 0 has them.
  std::uint64_t sites{0};
  ScanPace pace{};
};

[[nodiscard]] ScanPlan plan_scan(const CamTorus& torus, std::span<const std::size_t> which);

}  // namespace thimble::sim::cam
