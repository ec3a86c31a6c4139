#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/cambus/board_port.hpp"
#include "drivers/cambus/step_list_builder.hpp"
#include "drivers/cambus/step_list_check.hpp"
#include "drivers/cambus/video_timing.hpp"

namespace thimble::cambus {

// By the bits of register 26.
inline constexpr std::size_t kMachineInterrupts = field::kInterrupts<Register::IntFlags>.size();

// What became of the lists that were given to a board.
struct PlayCounters {
  std::uint64_t started{0};
  std::uint64_t done{0};
  std::uint64_t refused{0};                               // by the check: no board saw them
  std::uint64_t machine_interrupts{0};                    // that ended a list, and likewise:
  std::array<std::uint64_t, kMachineInterrupts> flags{};  // of these, as far as the machine said
  std::uint64_t bus_faults{0};
  std::uint64_t module_timeouts{0};  // no module answered
  std::uint64_t timed_out{0};        // we waited no longer
  std::uint64_t strange{0};          // the board said what it cannot have done
  bool operator==(const PlayCounters&) const = default;
};

// Gives a board one list after the other, each checked before, and says when it is over.
//
// After a failure the machine's registers are no longer known, and a list may still run, whose
// descriptors and buffers are the board's: the next one is kept here until the interface has been
// reset and waits, and only then written. It has to set up everything (CamProgram::set_up).
//
// With the reset the counters of a monitor's lines begin, where the board's clock allows it: lists
// may have synchronized scans then.
//
// Behind an interrupt of the machine a list of ours asks, in the rest of the time, for the flags
// that a reset leaves, of all modules at once.
//
// Thread: one at a time. No call waits. Ownership: the port must outlive it.
class ListPlayer {
 public:
  // Whether pulses run is settled here, whatever `limits` say.
  ListPlayer(BoardPort& port, const ListLimits& limits);

  // `at_most`: how long it may take until it is over, by the clock that `now` is of.
  // Errors: Busy while one plays; Malformed or TooLarge for a list that no board is given, or that
  // the window does not hold; Disconnected. None of them changes what plays.
  [[nodiscard]] Result<void> start(StepList list, Duration at_most, MonotonicTime now);
  // Begins a turn of the port. Whether it is over, or there is none. Once it failed there is none,
  // and each error comes once: Disconnected (for good), Timeout (no module answered, or not in
  // time), System (the machine interrupted, by which flags if it can be asked), Malformed (a bus
  // fault; or the board says what it cannot have done).
  [[nodiscard]] Result<bool> poll(MonotonicTime now);
  // What the last list has read; the list must be over.
  // Errors: Disconnected; Busy, the port has not brought it yet: ask again, after poll();
  // InvalidArgument for what does not lie in the window.
  [[nodiscard]] Result<std::vector<std::uint16_t>> words_of(const ReadSlot& slot,
                                                            MonotonicTime now);

  [[nodiscard]] bool is_playing() const noexcept { return phase_ != Phase::Idle; }
  // What the registers of the machine were is lost.
  [[nodiscard]] bool needs_set_up() const noexcept { return needs_set_up_; }
  [[nodiscard]] const PlayCounters& counters() const noexcept { return counters_; }
  // Nothing: the board shows nothing.
  [[nodiscard]] const std::optional<VideoTiming>& video() const noexcept { return video_; }

 private:
  // What is done next: nothing, ring the reset, wait until it is taken, write the list, ring for
  // it, wait until it is over; and of a list of ours, fetch the flags that it has read.
  enum class Phase { Idle, Clearing, Resetting, Putting, Giving, Playing, Naming };

  // Each goes on as far as it can now; whether the list is over.
  [[nodiscard]] Result<bool> look(MonotonicTime now);
  [[nodiscard]] IoStatus put();
  [[nodiscard]] Result<bool> go_on(const BoardStatus& status);
  [[nodiscard]] Result<bool> after_reset(const BoardStatus& status);
  [[nodiscard]] Result<bool> give(const BoardStatus& status);
  using Registers = std::array<std::uint32_t, page::kHostRegisters>;
  [[nodiscard]] Result<bool> ring(const Registers& registers, std::uint32_t meant, Phase next);
  [[nodiscard]] Result<bool> ring_reset();
  [[nodiscard]] Result<bool> while_it_plays(const BoardStatus& status);
  [[nodiscard]] Result<bool> ask_for_flags(Error why);
  [[nodiscard]] Result<bool> name_flags();
  // What ended the list, if something did; counted.
  [[nodiscard]] std::optional<Error> ended_by(const BoardStatus& status);
  // What cannot be, since `before_`, with so many lists given.
  [[nodiscard]] std::optional<std::string> nonsense(const BoardStatus& status,
                                                    std::uint32_t lists) const;
  [[nodiscard]] std::uint32_t since(const BoardStatus& status,
                                    page::Interrupt which) const noexcept;
  [[nodiscard]] Error lost_board() const;
  [[nodiscard]] tl::unexpected<Error> stop(Error why);
  [[nodiscard]] tl::unexpected<Error> strange(const std::string& what);

  BoardPort* port_;
  std::optional<VideoTiming> video_;
  ListLimits limits_;
  Phase phase_{Phase::Idle};
  bool needs_set_up_{true};
  bool needs_reset_{true};            // whatever played before us
  std::optional<Error> interrupted_;  // while the machine is asked why
  ReadSlot flags_;
  StepList list_;                  // its bytes until they are written
  std::uint64_t soft_at_most_{0};  // interrupts that the list raises itself
  MonotonicTime until_{};
  BoardStatus seen_;                   // last
  std::optional<BoardStatus> before_;  // when nothing ran: the last list was over, or the reset
  PlayCounters counters_;
};

}  // namespace thimble::cambus
