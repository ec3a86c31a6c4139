#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sim/model/cam/cam_torus.hpp"
#include "sim/model/cam/plane_dram.hpp"
#include "sim/model/cam/scan_plan.hpp"
#include "sim/model/cam/table_cache.hpp"

namespace thimble::sim::cam {

struct alignas(64) WordBlock {
  std::array<Word, kBlockWords> words{};
};
using LayerWords = std::array<const Word*, cambus::kLayers>;
using LayerBlocks = std::array<WordBlock, cambus::kLayers>;

// What a block of sites is worked out in; kept between scans.
struct StepRooms {
  struct OfModule {
    LayerBlocks fetched{}, after{};
    LayerWords unglued{}, glued{};
  };
  std::vector<OfModule> modules{};
  std::vector<WordBlock> taken{};  // by module
  LayerBlocks entry{}, output{}, data{}, shown{};
  std::vector<WordBlock> rule{};
  std::vector<Word*> places{};
  std::vector<std::array<std::uint32_t, kBlockWords>> sites{};  // by order
};

// A scan of some modules in lockstep, a block of sites after the other: from the bits to the table,
// and back to where each came from.
// Thread: one at a time. Ownership: all that it is made of must outlive it.
class PlaneStep {
 public:
  struct Parts {
    const VectorKernels& kernels;
    const ScanPlan& plan;
    std::span<const std::size_t> which;
    std::span<const std::shared_ptr<const PreparedTable>> tables;  // as `which`
    std::vector<PlaneDram>& drams;                                 // of all modules
    StepRooms& rooms;
    std::optional<std::size_t> looked_at;  // whose display is, as `which`
  };
  PlaneStep(const CamTorus& torus, const Parts& parts);

  // So many words from visit `first` on; `host` is what the host says. What the module shows
  // that is looked at is in the rooms then.
  void visit(std::uint64_t first, std::size_t words, const LayerWords& host);
  // Leaves counters and scan indices as they are after so many visits.
  void finish(CamTorus& torus, std::uint64_t visits);

 private:
  // From where a layer takes what crosses an edge of its module.
  struct Wires {
    std::vector<std::size_t> others{};  // as in `which`
    Word constant{0};
  };
  // What of a layer of one module has to be done.
  struct Work {
    bool is_fetched{false};
    bool is_told{false};  // the table needs its entry bit, or its output is that
    bool is_stored{false};
    HalfCounts ones{};
    std::uint64_t events{0};
  };
  using ModuleWork = std::array<Work, cambus::kLayers>;

  void find_wires(const CamTorus& torus);
  void add_wire(std::size_t module, std::size_t pin, std::size_t layer, std::size_t axis,
                Wires& wires) const;
  void find_work(std::size_t i);
  void fetch(std::size_t i);
  void glue(std::size_t layer, std::size_t axis);
  [[nodiscard]] bool take(std::size_t i, std::size_t layer, std::size_t axis);
  [[nodiscard]] LayerWords look_up(std::size_t i, const LayerWords& host);
  void work(std::size_t i, const LayerWords& host);
  void work_on(std::size_t i, std::size_t layer, const LayerWords& host, const Word* output);
  [[nodiscard]] const Word* evaluate(const PlaneSource& source, std::size_t i, std::size_t layer,
                                     const LayerWords& host, const Word* fourth, Word* room) const;
  [[nodiscard]] const Word* address_bit(const LayerPlan& layer, Word* room) const;
  // `words` at the sites that are visited, elsewhere `others`.
  [[nodiscard]] const Word* where_visited(const Word* words, const Word* others, Word* room) const;

  Parts parts_;
  std::array<std::array<bool, 3>, cambus::kLayers> may_cross_{};
  std::vector<std::array<std::array<Wires, 3>, cambus::kLayers>> wires_;
  std::vector<ModuleWork> work_;
  std::vector<bool> is_looked_up_;
  Word visited_;                  // sites of each word
  std::vector<SiteWords> sites_;  // of this block, by order
  std::size_t words_{0};
};

}  // namespace thimble::sim::cam
