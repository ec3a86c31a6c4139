#include "lab/run/uart.hpp"

#include <algorithm>

#include "daemon/link/earliest.hpp"

namespace thimble::lab {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
constexpr int kStopBit = 9;

}  // namespace

// Whole seconds apart, so that nothing overflows.
std::int64_t BitClock::bit_at(MonotonicTime t) const noexcept {
  const std::int64_t ns = t.since_epoch.count();
  return ns / kNanosecondsPerSecond * bit_per_s_ +
         ns % kNanosecondsPerSecond * bit_per_s_ / kNanosecondsPerSecond;
}

Duration BitClock::time_of(std::int64_t bits) const noexcept {
  const std::int64_t rest = bits % bit_per_s_ * kNanosecondsPerSecond;
  return Duration(bits / bit_per_s_ * kNanosecondsPerSecond + (rest + bit_per_s_ - 1) / bit_per_s_);
}

MonotonicTime BitClock::begin_of(std::int64_t bit) const noexcept { return {time_of(bit)}; }

void UartSender::put(std::span<const std::byte> bytes, MonotonicTime now) {
  const std::int64_t under_way = clock_.bit_at(now);
  const std::int64_t next = clock_.begin_of(under_way) < now ? under_way + 1 : under_way;
  free_from_ = std::max(free_from_, next);
  for (const std::byte byte : bytes) {
    sent_.push_back({free_from_, byte});
    free_from_ += kBitsOfByte;
  }
}

std::size_t UartSender::held(MonotonicTime now) const noexcept {
  const std::int64_t bits = std::max<std::int64_t>(0, free_from_ - clock_.bit_at(now));
  return static_cast<std::size_t>((bits + kBitsOfByte - 1) / kBitsOfByte);
}

MonotonicTime UartSender::comes_down_to(std::size_t bytes) const noexcept {
  return clock_.begin_of(
      std::max<std::int64_t>(0, free_from_ - static_cast<std::int64_t>(bytes) * kBitsOfByte));
}

bool UartSender::is_high_in(const Sent& sent, std::int64_t bit) noexcept {
  const std::int64_t n = bit - sent.begin;
  if (n == 0) return false;
  return n == kStopBit || (std::to_integer<unsigned>(sent.byte) >> (n - 1) & 1U) != 0;
}

bool UartSender::is_high(std::int64_t bit) const noexcept {
  for (const Sent& sent : sent_) {
    if (bit < sent.begin) return true;
    if (bit < sent.begin + kBitsOfByte) return is_high_in(sent, bit);
  }
  return true;
}

std::optional<std::int64_t> UartSender::fall_from(std::int64_t from) const noexcept {
  for (const Sent& sent : sent_) {
    for (std::int64_t bit = std::max(from, sent.begin); bit < sent.begin + kBitsOfByte; ++bit) {
      const bool was_high = bit == sent.begin || is_high_in(sent, bit - 1);
      if (was_high && !is_high_in(sent, bit)) return bit;
    }
  }
  return std::nullopt;
}

void UartSender::forget_before(std::int64_t bit) {
  while (!sent_.empty() && sent_.front().begin + kBitsOfByte <= bit) sent_.pop_front();
}

std::int64_t UartReceiver::heard_until(const UartSender& from) const noexcept {
  return listens_from_.value_or(from.clock().bit_at(since_));
}

std::int64_t UartReceiver::middle_of(int n, std::int64_t start,
                                     const UartSender& from) const noexcept {
  return start + (2 * n + 1) * from.clock().bit_per_s() / (2 * clock_.bit_per_s());
}

std::optional<UartReceiver::Coming> UartReceiver::next(const UartSender& from) const noexcept {
  const std::optional<std::int64_t> start = from.fall_from(heard_until(from));
  if (!start) return std::nullopt;
  return Coming{*start, from.clock().begin_of(*start) + clock_.time_of(kBitsOfByte)};
}

MonotonicTime UartReceiver::silent_at() const noexcept {
  return last_at_ + clock_.time_of(kSilentBytes * kBitsOfByte);
}

std::vector<std::byte> UartReceiver::hear(const UartSender& from, MonotonicTime now) {
  std::vector<std::byte> out;
  const auto hand_over = [&] {
    out.insert(out.end(), chip_.begin(), chip_.end());
    chip_.clear();
  };
  for (auto coming = next(from); coming && coming->whole_at <= now; coming = next(from)) {
    unsigned byte = 0;
    for (int n = 1; n < kStopBit; ++n) {
      if (from.is_high(middle_of(n, coming->start, from))) byte |= 1U << (n - 1);
    }
    // A stop bit that is low is no matter: as a line is set up here, the byte counts
    // (hal/linux/serial_line.cpp, no INPCK), and the next start bit is where the line falls again.
    listens_from_ = middle_of(kStopBit, coming->start, from) + 1;
    chip_.push_back(static_cast<std::byte>(byte));
    last_at_ = coming->whole_at;
    if (chip_.size() >= kTrigger) hand_over();
  }
  if (!chip_.empty() && silent_at() <= now) hand_over();
  return out;
}

std::optional<MonotonicTime> UartReceiver::due(const UartSender& from) const {
  const std::optional<Coming> coming = next(from);
  std::optional<MonotonicTime> due;
  const bool falls_silent = !chip_.empty() && (!coming || silent_at() < coming->whole_at);
  if (falls_silent) due = silent_at();
  if (!coming) return due;
  // No sooner than so many bytes later is there something to hand over.
  const auto missing = static_cast<std::int64_t>(kTrigger - chip_.size());
  const std::int64_t bytes = std::min(missing - 1, kSilentBytes);
  link::take_earlier(due, coming->whole_at + clock_.time_of(bytes * kBitsOfByte));
  return due;
}

}  // namespace thimble::lab
