#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "hal/base/time.hpp"

// The two chips of one direction of a serial line, bit by bit: a start bit, which is low, eight
// data bits, the lowest first, and a stop bit; between bytes the line is high. Of one rate, they
// hear what is sent; of two, a receiver takes for a bit whatever it finds in the middle of where
// one would be.
//
// Thread: one. Deterministic: whole numbers only. Errors: none.
namespace thimble::lab {

inline constexpr std::int64_t kBitsOfByte = 10;

// The bits of a line, numbered from time 0 on, as its sender's clock cuts them.
class BitClock {
 public:
  explicit BitClock(std::uint32_t bit_per_s) noexcept : bit_per_s_(bit_per_s) {}
  [[nodiscard]] std::int64_t bit_per_s() const noexcept { return bit_per_s_; }
  [[nodiscard]] std::int64_t bit_at(MonotonicTime t) const noexcept;  // that is under way
  [[nodiscard]] MonotonicTime begin_of(std::int64_t bit) const noexcept;
  // Of so many of them, rounded up.
  [[nodiscard]] Duration time_of(std::int64_t bits) const noexcept;

 private:
  std::int64_t bit_per_s_;
};

class UartSender {
 public:
  explicit UartSender(std::uint32_t bit_per_s) noexcept : clock_(bit_per_s) {}

  // Behind what is still to leave.
  void put(std::span<const std::byte> bytes, MonotonicTime now);
  // Bytes that have not left, the one that is leaving with them.
  [[nodiscard]] std::size_t held(MonotonicTime now) const noexcept;
  // When held() has come down to `bytes`, if no more are put.
  [[nodiscard]] MonotonicTime comes_down_to(std::size_t bytes) const noexcept;

  // What is on the line, which is everything that has not been forgotten.
  [[nodiscard]] const BitClock& clock() const noexcept { return clock_; }
  [[nodiscard]] bool is_high(std::int64_t bit) const noexcept;
  // The first bit from `from` on that is low behind one that is high; nothing: none was put yet.
  [[nodiscard]] std::optional<std::int64_t> fall_from(std::int64_t from) const noexcept;
  // Bytes that had left before that bit.
  void forget_before(std::int64_t bit);

 private:
  struct Sent {
    std::int64_t begin{0};  // its start bit
    std::byte byte{};
  };
  [[nodiscard]] static bool is_high_in(const Sent& sent, std::int64_t bit) noexcept;

  BitClock clock_;
  std::int64_t free_from_{0};  // bit
  std::deque<Sent> sent_;
};

// What is heard waits in the chip until there is enough of it, or the line has been silent.
class UartReceiver {
 public:
  // SOURCE: Linux's trigger for a 16550A (drivers/tty/serial/8250/8250_port.c,
  // UART_FCR_R_TRIG_10), and the character time-out of its data sheet (PC16550D).
  static constexpr std::size_t kTrigger = 8;
  static constexpr std::int64_t kSilentBytes = 4;

  // Hears from `since` on, in the middle of a byte if need be.
  UartReceiver(std::uint32_t bit_per_s, MonotonicTime since) noexcept
      : clock_(bit_per_s), since_(since) {}

  // What is handed over by `now`, of all that came from that sender, which is always the same one.
  [[nodiscard]] std::vector<std::byte> hear(const UartSender& from, MonotonicTime now);
  // When to hear again at the latest; nothing: when more has been put.
  [[nodiscard]] std::optional<MonotonicTime> due(const UartSender& from) const;
  // Nothing before this bit of the sender's is asked for again.
  [[nodiscard]] std::int64_t heard_until(const UartSender& from) const noexcept;

 private:
  struct Coming {
    std::int64_t start{0};     // bit of the sender's
    MonotonicTime whole_at{};  // when this one has its stop bit
  };
  [[nodiscard]] std::optional<Coming> next(const UartSender& from) const noexcept;
  [[nodiscard]] MonotonicTime silent_at() const noexcept;
  // The sender's bit in the middle of the n-th of ours behind `start`.
  [[nodiscard]] std::int64_t middle_of(int n, std::int64_t start,
                                       const UartSender& from) const noexcept;

  BitClock clock_;
  MonotonicTime since_;
  std::optional<std::int64_t> listens_from_;  // bit of the sender's; none: nothing heard yet
  std::vector<std::byte> chip_;
  MonotonicTime last_at_{};  // of chip_
};

}  // namespace thimble::lab
