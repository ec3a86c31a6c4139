#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::sim {

// A byte on its way over an asynchronous serial line: one start bit, eight data bits from the
// lowest on, one stop bit.
inline constexpr int kSerialBitsPerByte = 10;

struct SerialByte {
  std::uint8_t value{0};
  double speed_baud{9600};  // of the sender, > 0
};

struct ReceivedByte {
  std::uint8_t value{0};
  bool has_stop_bit{true};  // false: a framing error
};

// What a receiver makes of a byte that was sent at another speed: it finds the start bit and looks
// at the line once in the middle of each of its own bits. Within about 5 % that is what was sent;
// beyond, it is garbage of the kind a real one sees. One byte in, one byte out: that a much faster
// receiver would see several is left out.
// Thread: any. RT. Errors: none; a speed that is not positive gives a framing error.
THIMBLE_RT [[nodiscard]] ReceivedByte receive_at(SerialByte sent, double speed_baud) noexcept;

// How long a byte takes.
THIMBLE_RT [[nodiscard]] Duration serial_byte_time(double speed_baud) noexcept;

// A point in time that never comes.
inline constexpr MonotonicTime kNeverInTime{Duration::max()};

// The sending half of a UART: a FIFO before a shift register. A byte leaves the FIFO when the one
// before it is through, and has arrived when its last bit has.
// Thread: one. RT: all. Errors: none; what does not fit into the FIFO is refused.
template <std::size_t Capacity>
class SerialSender {
 public:
  [[nodiscard]] std::size_t room() const noexcept { return Capacity - count_; }
  [[nodiscard]] bool is_idle() const noexcept { return count_ == 0 && !is_shifting_; }
  // Those that wait, and the one in the shift register.
  [[nodiscard]] std::size_t under_way() const noexcept { return count_ + (is_shifting_ ? 1U : 0U); }
  // `t` is not before any earlier one. False: no room, nothing taken.
  THIMBLE_RT bool push(MonotonicTime t, std::uint8_t value) noexcept {
    if (count_ == Capacity) return false;
    waiting_[(first_ + count_) % Capacity] = value;
    ++count_;
    if (!is_shifting_) shift_next(t);
    return true;
  }
  // From the next byte on. `speed_baud` > 0.
  void set_speed(double speed_baud) noexcept { speed_baud_ = speed_baud; }
  [[nodiscard]] double speed_baud() const noexcept { return speed_baud_; }
  // When the byte in the shift register has arrived; kNeverInTime when there is none.
  [[nodiscard]] MonotonicTime next_arrival() const noexcept {
    return is_shifting_ ? arrives_at_ : kNeverInTime;
  }
  // That byte; only when there is one.
  THIMBLE_RT SerialByte take_arrived() noexcept {
    const SerialByte arrived = shifting_;
    is_shifting_ = false;
    if (count_ > 0) shift_next(arrives_at_);
    return arrived;
  }
  // Those that wait are gone; the one in the shift register goes on.
  THIMBLE_RT void forget_waiting() noexcept { count_ = 0; }
  THIMBLE_RT void forget_all() noexcept {
    count_ = 0;
    is_shifting_ = false;
  }

 private:
  void shift_next(MonotonicTime t) noexcept {
    shifting_ = {waiting_[first_], speed_baud_};
    first_ = (first_ + 1) % Capacity;
    --count_;
    is_shifting_ = true;
    arrives_at_ = t + serial_byte_time(speed_baud_);
  }

  double speed_baud_{9600};
  std::array<std::uint8_t, Capacity> waiting_{};
  std::size_t first_{0};
  std::size_t count_{0};
  bool is_shifting_{false};
  SerialByte shifting_{};
  MonotonicTime arrives_at_{};
};

}  // namespace thimble::sim
