#pragma once

#include <memory>
#include <optional>

#include "hal/base/time.hpp"
#include "hal/bus/memory_window.hpp"
#include "sim/bus/sim_memory_window.hpp"
#include "sim/model/cam/board_page.hpp"

namespace thimble::sim::cam {

// A whole board in a slot of a simulated PCI bus: whoever touches its window finds it as it is at
// that time. It runs in the thread that does, for as long as it takes to catch up: a scan is done
// by whom it is for, never by a thread that drives an arm.
//
// Thread: one at a time, with its windows. Ownership: the clock must outlive it, and it its
// windows.
class SimCamBoard {
 public:
  SimCamBoard(const Clock& clock, const BoardOptions& options);

  // The BAR, as a host maps it.
  [[nodiscard]] std::unique_ptr<bus::MemoryWindow> open_window();

  // What may happen to a board.
  void unplug() noexcept { memory_->unplug(); }
  // It does nothing any more; its memory stays as it is.
  void freeze() noexcept { is_frozen_ = true; }
  // Everything is lost, and there is another incarnation.
  void power_cycle();

  // Brings it to the present.
  void serve();
  [[nodiscard]] BoardPage& board() noexcept { return *board_; }

 private:
  const Clock* clock_;
  BoardOptions options_;
  std::shared_ptr<SimMemory> memory_;
  std::optional<BoardPage> board_;
  bool is_frozen_{false};
};

}  // namespace thimble::sim::cam
