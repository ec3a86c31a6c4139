#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "hal/rt/static_vector.hpp"
#include "sim/model/cam/engine/block_team.hpp"
#include "sim/model/cam/engine/engine.hpp"
#include "sim/model/cam/engine/plane_rule.hpp"
#include "sim/model/cam/engine/site_planes.hpp"
#include "sim/model/cam/engine/vector_kernels.hpp"

namespace thimble::sim::cam {

// How a table is applied: looked up for each site, as operations on planes, or whichever of both is
// faster.
enum class TablePath : std::uint8_t { General, Compiled, Auto };

// The fast engine: layers as planes of bits that stay where they are, kicks as offsets, blocks of
// 4096 sites at a time, by the instruction set of `kernels`. Tables that compile are checked
// against all of their entries when they are loaded.
//
// Two bytes a site, at most as much again, and half a MiB for each thread. load() may take 50 ms, a
// step is bound by the number of sites. Errors of load(): Unsupported for a table that does not
// compile, when nothing else is allowed.
class PlaneEngine final : public Engine {
 public:
  // SOURCE: ours; far more than share one memory with profit.
  static constexpr std::size_t kMostThreads = 64;

  // Scans that are long enough for it are shared by so many threads, the caller's included: the
  // same bits and counts, whoever did which block. Errors: InvalidArgument for a space or a number
  // of threads that cannot be, System where the system has no thread left.
  [[nodiscard]] static Result<std::unique_ptr<PlaneEngine>> make(
      const SiteSpace& space, TablePath path,
      const VectorKernels& kernels = *usable_kernels().front(), std::size_t threads = 1);

  [[nodiscard]] const SiteSpace& space() const noexcept override { return planes_.space(); }
  Result<void> put(std::span<const std::uint16_t> sites) override;
  Result<void> get(std::span<std::uint16_t> sites) override;
  // One layer: bit i % 64 of word i / 64 is that of site i. Errors: InvalidArgument for a layer
  // that is not there, or another number of words than the space has.
  Result<void> get_layer(std::size_t layer, std::span<Word> bits);
  Result<void> load(std::size_t bank, std::span<const std::uint16_t> table) override;
  Result<PlaneCounts> step(std::span<const PlaneKick> kicks, const StepOptions& options) override;
  [[nodiscard]] PlaneCounts population() override;

  // Of the bank's rule; nothing where it is looked up.
  [[nodiscard]] std::optional<std::size_t> compiled_ops(std::size_t bank) const;

 private:
  struct alignas(64) Block {
    std::array<Word, kBlockWords> words{};
  };
  struct Table {
    std::vector<std::uint16_t> entries{};
    TableShape shape{};
    std::optional<PlaneRule> rule{};
  };
  // What a step works out, decided before its first block.
  struct Plan {
    const Table* table{nullptr};
    StepOptions options{};
    LayerBits kept{0};  // layers that stay as they are
    LayerBits made{0};  // outputs that somebody needs, of those with the same function the first
    std::array<std::uint8_t, kPlanes> source{};  // which of them a layer's bit is
    std::array<std::optional<SitePlanes::Plane>, kPlanes> planes{};  // where an output goes
    rt::StaticVector<std::uint8_t, kPlanes> fetched{};  // layers that are looked at, block by block
    rt::StaticVector<std::uint8_t, kPlanes> worked_out{};  // as `made`
  };
  // What one thread has of its own.
  struct alignas(64) Hand {
    std::vector<Block> rooms{};
    std::vector<Word*> places{};  // a block's inputs and outputs, and what a rule needs besides
    PlaneCounts ones{};           // in the blocks that it did
  };

  PlaneEngine(const SiteSpace& space, TablePath path, const VectorKernels& kernels,
              std::size_t threads);
  [[nodiscard]] Plan make_plan(const StepOptions& options);
  void choose_layers(Plan& plan) const;
  void place_the_rest(const Plan& plan, Hand& hand);
  void place_block(const Plan& plan, std::size_t block, Hand& hand);
  void work_all(const Plan& plan);
  void work(const Plan& plan, std::size_t block, Hand& hand);
  [[nodiscard]] PlaneCounts made_ones() const;
  [[nodiscard]] PlaneCounts counts_of(const Plan& plan, const PlaneCounts& ones);
  void finish(const Plan& plan, const PlaneCounts& ones);

  TablePath path_;
  const VectorKernels* kernels_;
  SitePlanes planes_;
  std::array<Table, kBanks> tables_{};
  std::vector<Hand> hands_;  // by member of the team
  std::array<Block, 2> constants_{};
  BlockTeam team_;
};

}  // namespace thimble::sim::cam
