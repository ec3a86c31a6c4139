#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "drivers/phantom/controller_link.hpp"
#include "drivers/phantom/phantom_model.hpp"
#include "drivers/phantom/text_codec.hpp"
#include "drivers/phantom/zero_jump.hpp"
#include "hal/bus/serial_port.hpp"

namespace thimble::phantom {

// The controller's lines of text (text_wire.hpp) over a serial port.
//
// One message is under way, so that none queues behind others: the next leaves when the last is
// answered, or kPatience after it. Only a zero does not wait while a current is under way: it goes
// at once, and of two that the controller finds together it takes the newer (kToLose). An answer
// that says that the message was not taken, that is of another arm than the configuration's, or
// whose counters no arm of the table can have, is no sample. A press of the button shows as a flag
// (ZeroJump) until zero_counters().
//
// Thread, RT, Errors: as ControllerLink. Ownership: owns the port; the clock must outlive it.
class TextLink final : public ControllerLink {
 public:
  // `model` must be one of text::kBuilds, `amplifier_max_a` one that match() let pass; beyond that
  // no current is said.
  TextLink(std::unique_ptr<bus::SerialPort> port, const PhantomModel& model, double amplifier_max_a,
           const Clock& clock);
  // The last that the port sends is zero, answer or not.
  ~TextLink() override;
  TextLink(const TextLink&) = delete;
  TextLink& operator=(const TextLink&) = delete;

  THIMBLE_RT_IO IoStatus read(ControllerReport& out) noexcept override;
  // Backlogged as long as an answer is owed, but for a zero behind a current: such a command is
  // dropped and does not wait, the next tick has a newer one.
  THIMBLE_RT_IO IoStatus write_currents(const std::array<double, 3>& current_a) noexcept override;
  THIMBLE_RT_IO IoStatus zero_counters() noexcept override;
  [[nodiscard]] bool is_zeroed_by_press() const noexcept override { return true; }
  [[nodiscard]] bool is_press_unseen() const noexcept override {
    return is_press_unseen_.load(std::memory_order_relaxed);
  }
  [[nodiscard]] Duration watchdog() const noexcept override { return text::kWatchdog; }
  [[nodiscard]] DeviceCounters counters() const noexcept override;
  [[nodiscard]] ZeroCommand zero_command() const noexcept override;
  [[nodiscard]] std::string_view trouble() const noexcept override;

  // Ours: an answer takes less than 1 ms and up to a tick to be seen, and after 20 ms without one
  // the servo stops the arm.
  static constexpr Duration kPatience = std::chrono::milliseconds(4);

 private:
  void take_chunk() noexcept;
  void take_line(std::span<const std::uint8_t> line) noexcept;

  std::unique_ptr<bus::SerialPort> port_;
  double amplifier_max_a_;
  std::int32_t build_number_;
  std::string other_arm_;  // what to say then
  const Clock* clock_;
  bus::SerialChunk chunk_{};
  std::uint64_t last_chunk_{0};
  TextLines lines_;
  ZeroJump jump_;
  ControllerReport newest_{};
  bool is_fresh_{false};
  bool is_disturbed_{false};
  std::uint8_t answers_owed_{0};
  bool is_current_sent_{false};  // by the newest message
  MonotonicTime asked_at_{};
  // Read from any thread.
  std::atomic<bool> is_other_arm_{false};
  std::atomic<bool> is_press_unseen_{false};
  std::atomic<std::uint64_t> reports_{0};
  std::atomic<std::uint64_t> skipped_{0};
  std::atomic<std::uint64_t> malformed_{0};
};

}  // namespace thimble::phantom
