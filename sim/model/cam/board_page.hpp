#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "drivers/cambus/cambus_page_wire.hpp"
#include "hal/base/time.hpp"
#include "hal/bus/shared_words.hpp"
#include "sim/model/cam/step_interface.hpp"

namespace thimble::sim::cam {

struct BoardOptions {
  TorusShape shape{};
  std::uint32_t clock_hz{25'000'000};
  std::size_t window_bytes{std::size_t{1} << 20};  // a multiple of 16
  std::uint32_t incarnation{1};
  // The machine's clock keeps to the time it is served at; else every list is over at once.
  bool is_paced{true};
  Scanning scanning{Scanning::Fast};
  // Of the thread that serves it, where that serves others too: a list that takes long is played
  // BoardPage::kMostAtOnce at a time. Nothing: it is played to its end. Has to outlive the board.
  const Clock* thread_clock{nullptr};
};

struct BoardCounters {
  std::uint64_t doorbells{0};
  bool operator==(const BoardCounters&) const = default;
};

// A board as its page shows it (docs/cambus.md, section 6), in memory that a host shares: takes
// what the host rings for, lets the interface card play, shows what has become of it.
//
// Time: serve() brings the board to a time. What the page shows is as of the end of the last step
// that was over by then; what a step reads lies in its buffer from the step's beginning on.
// Exact: the order of everything, and by the machine's clock when it happens. Approximated: a reset
// in the middle of a step takes back no bit that the step has moved.
// Thread: one; the host is another. Ownership: the memory must outlive it.
class BoardPage {
 public:
  // `memory`: of bytes_of(options), all 0.
  BoardPage(const BoardOptions& options, bus::SharedWords memory, MonotonicTime now);
  [[nodiscard]] static std::size_t bytes_of(const BoardOptions& options) noexcept {
    return cambus::page::kPageBytes + options.window_bytes;
  }

  // A list that never ends is left after so many steps, until the next time.
  static constexpr int kMostSteps = 100'000;
  // By the thread's clock: so long, and what the last step takes more; then it rests, as a host
  // serves it several times in one look. Ours: half a period of the servo's default, and more than
  // a look takes.
  static constexpr Duration kMostAtOnce = std::chrono::microseconds(500);
  static constexpr Duration kRest = std::chrono::microseconds(50);
  void serve(MonotonicTime now);

  // The inside, for tests and for what puts patterns into a world.
  [[nodiscard]] CamMachine& machine() noexcept { return machine_; }
  [[nodiscard]] const CamMachine& machine() const noexcept { return machine_; }
  [[nodiscard]] const BoardCounters& counters() const noexcept { return counters_; }

 private:
  struct Shown {
    std::array<std::uint32_t, cambus::page::kHostRegisters> registers{};
    std::array<std::uint32_t, cambus::page::kInterrupts> raised{};
  };

  // Registers, acknowledge, counts: those under the version word.
  using StatusWords = std::array<std::uint32_t, (cambus::page::kMoment - cambus::page::kRead) / 4>;

  [[nodiscard]] std::uint64_t clocks_at(MonotonicTime now) const noexcept;
  void show_identity(const BoardOptions& options);
  void catch_up(std::uint64_t clocks);
  [[nodiscard]] bool may_go_on();
  void take_doorbell(std::uint64_t clocks);
  void control(std::uint32_t word, std::uint64_t clocks);
  void take_display_lengths(std::uint32_t meant);
  void look();
  [[nodiscard]] std::uint32_t list_register() const noexcept;
  [[nodiscard]] std::uint32_t control_register() const noexcept;
  void show(MonotonicTime now);

  bus::SharedWords memory_;
  CamMachine machine_;
  StepInterface interface_;
  MonotonicTime start_;
  std::uint32_t clock_hz_;
  bool is_paced_;
  const Clock* thread_clock_;
  std::optional<MonotonicTime> working_since_;  // by it
  MonotonicTime rests_until_{};
  std::uint32_t acknowledged_{0};
  SyncLengths display_{};
  bool has_next_list_{false};  // given during a step, which it waits for
  std::uint32_t next_list_{0};
  std::uint32_t enabled_{0};     // interrupts
  std::uint32_t exceptions_{0};  // those of machine interrupts and time-outs: bits 5 and 6 disable
  Shown shown_;
  StatusWords on_page_{};
  std::uint32_t moment_{0};
  BoardCounters counters_;
};

}  // namespace thimble::sim::cam
