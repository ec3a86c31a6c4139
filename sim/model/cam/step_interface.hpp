#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "drivers/cambus/cambus_page_wire.hpp"
#include "hal/bus/shared_words.hpp"
#include "sim/model/cam/cam_machine.hpp"

namespace thimble::sim::cam {

// The interface card: fetches step lists from a window of memory and plays them on the machine
// (docs/cambus.md, sections 3 and 4). Whatever the window holds, it stays within it and each step
// ends. What a host writes and reads of it is in board_page.hpp.
// Thread: one at a time.
class StepInterface {
 public:
  enum class State { Waiting, Executing, Halted };
  using Interrupt = cambus::page::Interrupt;

  // `window` is a view; offsets of lists are offsets in it.
  StepInterface(CamMachine& machine, bus::SharedWords window)
      : machine_(machine), window_(window) {}

  // The host gives a list; it starts at once when the card waits, else behind the one that runs.
  void write_next_list(std::uint32_t offset);
  // After an error: lists start again.
  void clear_exception();
  // The host wants no more steps, until it clears the exception.
  void stop_for_host() { state_ = State::Halted; }
  // As at power on, the machine too, but for what a reset leaves; no interrupt has been raised.
  void reset();
  // One step. Returns whether there may be another one.
  bool step();
  // Until the card waits, is halted, or has done so many steps. Returns whether it came to rest.
  bool run(std::uint64_t most_steps);

  [[nodiscard]] State state() const noexcept { return state_; }
  // What ended the last list, until the exception is cleared.
  [[nodiscard]] std::optional<Interrupt> error() const noexcept { return error_; }
  [[nodiscard]] bool is_list_pending() const noexcept { return is_pending_; }
  [[nodiscard]] std::uint32_t next() const noexcept { return next_; }
  [[nodiscard]] std::uint32_t current() const noexcept { return current_; }
  [[nodiscard]] std::uint32_t previous() const noexcept { return previous_; }
  [[nodiscard]] std::uint64_t interrupts(Interrupt which) const noexcept {
    return interrupts_[static_cast<std::size_t>(which)];
  }

 private:
  struct Step {
    std::uint32_t opcode, buffer, length, link;
  };

  [[nodiscard]] bool lies_within(std::uint32_t offset, std::uint64_t bytes) const noexcept;
  [[nodiscard]] std::uint16_t half(std::uint32_t offset) const noexcept;
  void put_byte(std::uint32_t offset, std::uint8_t value) noexcept;
  [[nodiscard]] bool play(const Step& step);
  [[nodiscard]] bool move(const Step& step);
  [[nodiscard]] bool send(const Step& step);
  [[nodiscard]] bool fetch(const Step& step);
  void go_on(const Step& step);
  void start_pending();
  void raise(Interrupt which) { ++interrupts_[static_cast<std::size_t>(which)]; }
  bool halt(Interrupt why);

  CamMachine& machine_;
  bus::SharedWords window_;
  State state_{State::Waiting};
  bool is_pending_{false};
  std::uint32_t next_{0};
  std::uint32_t current_{0};
  std::uint32_t previous_{0};
  std::optional<Interrupt> error_;
  std::array<std::uint64_t, cambus::page::kInterrupts> interrupts_{};
};

}  // namespace thimble::sim::cam
