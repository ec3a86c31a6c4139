#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "daemon/world/cell_edit.hpp"
#include "daemon/world/voxel_world.hpp"
#include "hal/base/result.hpp"

namespace thimble::world {

// Edits of a world that wait their turn, and are applied in slices of bounded work between two
// answers of that world: the fill of 1024^3 cells takes some 2200 slices, none longer than that of
// a small world. Order is kept; within an edit, rows go up z, then y.
//
// Thread: the world's. Not RT; step() is bounded, and allocates only to tell of a finished batch.
// Ownership: the world must outlive it. Errors: submit() only, and then nothing is changed.
class EditQueue {
 public:
  // Ours: rows of up to 64 cells that one slice may touch; some 50 us on a slow machine.
  static constexpr std::size_t kSliceWords = 8192;
  // Ours: more than that is somebody who does not wait for answers.
  static constexpr std::size_t kMaxBatches = 64;
  // Ours: what may wait altogether, rows of up to 64 cells; two fills of 1024^3 cells, some 4 s of
  // slices a millisecond apart. Who asks then is refused rather than kept waiting.
  static constexpr std::size_t kMaxWaitingWords = 4200 * kSliceWords;

  struct Finished {
    std::uint64_t batch{0};
    std::uint64_t changed_cells{0};  // that were free and are filled now, or the other way round
  };

  explicit EditQueue(VoxelWorld& world) noexcept : world_(&world) {}

  // The number of the batch, from 1. All of it is taken or nothing: InvalidArgument as
  // check_edit(), the place in the list in front where there are several; TooLarge where it alone
  // is more than kMaxWaitingWords; Busy while too much waits.
  [[nodiscard]] Result<std::uint64_t> submit(std::vector<CellEdit> edits);
  // Drops the batch unless it has begun, is done or was never there.
  void withdraw(std::uint64_t batch);
  // One slice, of what has waited longest.
  void step();
  [[nodiscard]] bool is_idle() const noexcept { return batches_.empty(); }
  // Batches that came to an end since the last call.
  [[nodiscard]] std::vector<Finished> take_finished();

  // Single edits, since the start.
  [[nodiscard]] std::uint64_t applied() const noexcept { return applied_; }
  [[nodiscard]] std::uint64_t waiting() const noexcept { return waiting_; }

 private:
  struct Batch {
    std::uint64_t number{0};
    std::vector<CellEdit> edits;
    std::size_t words{0};  // of all its edits
    std::size_t next{0};   // of edits
    Cell row{};            // of that edit, the next to be done
    bool is_begun{false};
    std::uint64_t changed_cells{0};
  };

  // True when the edit is done.
  bool advance(Batch& batch, const CellEdit& edit, std::size_t& words_left) noexcept;
  std::size_t apply_row(const CellEdit& edit, Cell row, std::size_t& words) noexcept;

  VoxelWorld* world_;
  std::deque<Batch> batches_;
  std::vector<Finished> finished_;
  std::uint64_t last_number_{0};
  std::uint64_t applied_{0};
  std::uint64_t waiting_{0};
  std::size_t waiting_words_{0};  // of batches not yet done
};

}  // namespace thimble::world
