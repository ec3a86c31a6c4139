#pragma once

#include <cstdint>
#include <optional>

#include "daemon/coupling/messages.hpp"
#include "daemon/world/world.hpp"
#include "hal/base/result.hpp"

namespace thimble::coupling {

// The probe of one hand in a world, the buttons that its person presses there, and what else is
// asked by it.
//
// Thread: the world's. Not RT; press() and move() wait for nothing, and allocate only where the
// world's press() and move_probe() do; open() allocates.
// Ownership: the world must outlive it; the destructor closes.
// Errors: open() refuses a hand that is not finite, and passes on what the world says.
class ProbeInWorld {
 public:
  explicit ProbeInWorld(world::World& world) noexcept : world_(world) {}
  ~ProbeInWorld() { close(); }
  ProbeInWorld(const ProbeInWorld&) = delete;
  ProbeInWorld& operator=(const ProbeInWorld&) = delete;

  [[nodiscard]] Result<void> open(const HandSample& first);
  [[nodiscard]] bool is_open() const noexcept { return probe_.has_value(); }
  // Whether its motion tells a cell.
  [[nodiscard]] bool is_among_cells() const noexcept { return world_.felt_cells() != nullptr; }
  // Only while open: tells the world the buttons that were pressed since the sample before, each as
  // often as it was, also in samples that never came; by their counts where the sample has them,
  // else by what is pressed now and was not before. More than kMostPresses of one wait for the
  // samples that follow. Of the actions that were asked likewise one of each at most; what the
  // world does not take it is asked again. A sample that a later one has overtaken says nothing.
  static constexpr int kMostPresses = 4;  // ours: of a person in a third of a second
  void hear(const HandSample& sample) noexcept;
  // Only while open: moves the probe towards `at`; `dt` >= 0 since the call before.
  [[nodiscard]] world::ProbeMotion move(Position3 at, Duration dt) noexcept;
  void close() noexcept;

 private:
  void press(const HandSample& sample) noexcept;
  void ask(const HandSample& sample) noexcept;

  world::World& world_;
  std::optional<world::ProbeId> probe_{};
  std::uint64_t newest_{0};   // sequence of the newest sample heard
  std::uint32_t buttons_{0};  // of the sample before
  PressCounts told_{};        // presses that the world knows
  ActionCounts asked_{};      // what it has taken
};

}  // namespace thimble::coupling
