#include "daemon/link/serial_frame.hpp"

#include <algorithm>
#include <utility>

#include "daemon/link/network_bytes.hpp"

namespace thimble::link {
namespace {

constexpr std::size_t kMostInBlock = 254;  // bytes behind one code byte

constexpr std::array<std::uint32_t, 256> make_crc_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < table.size(); ++i) {
    std::uint32_t word = i;
    for (int bit = 0; bit < 8; ++bit) {
      word = (word >> 1U) ^ ((word & 1U) != 0 ? 0xEDB88320U : 0U);  // the polynomial, reflected
    }
    table[i] = word;
  }
  return table;
}
constexpr std::array<std::uint32_t, 256> kCrcTable = make_crc_table();

// COBS: each run without a zero behind the number of its bytes plus one.
std::size_t stuff(std::span<const std::byte> plain, std::span<std::byte> out) noexcept {
  std::size_t code_at = 0;
  std::size_t size = 1;
  for (const std::byte byte : plain) {
    if (byte != std::byte{0}) out[size++] = byte;
    const std::size_t run = size - code_at;
    if (byte != std::byte{0} && run <= kMostInBlock) continue;
    out[code_at] = static_cast<std::byte>(run);
    code_at = size++;
  }
  out[code_at] = static_cast<std::byte>(size - code_at);
  return size;
}

// Nothing where a run goes beyond the end.
std::optional<std::size_t> unstuff(std::span<const std::byte> stuffed,
                                   std::span<std::byte> out) noexcept {
  std::size_t size = 0;
  for (std::size_t at = 0; at < stuffed.size();) {
    const auto run = std::to_integer<std::size_t>(stuffed[at]);
    if (run == 0 || at + run > stuffed.size()) return std::nullopt;
    for (std::size_t i = 1; i < run; ++i) out[size++] = stuffed[at + i];
    at += run;
    const bool has_zero = run <= kMostInBlock && at < stuffed.size();
    if (has_zero) out[size++] = std::byte{0};
  }
  return size;
}

}  // namespace

std::uint32_t crc32(std::span<const std::byte> bytes) noexcept {
  std::uint32_t sum = 0xFFFFFFFFU;
  for (const std::byte byte : bytes) {
    sum = (sum >> 8U) ^ kCrcTable[(sum ^ std::to_integer<std::uint32_t>(byte)) & 0xFFU];
  }
  return ~sum;
}

SerialFrame frame(std::span<const std::byte> datagram) noexcept {
  SerialFrame out;
  if (datagram.empty() || datagram.size() > kMaxThimbleDatagram) return out;
  std::array<std::byte, kMaxFramed> plain{};
  ByteWriter writer(plain);
  writer.block(datagram);
  writer.values(crc32(datagram));
  const std::size_t size =
      stuff(std::span(plain).first(writer.size()), std::span(out.bytes).subspan(1));
  out.size = size + 2;  // the zeros at either end are there
  return out;
}

void Deframer::on_read(MonotonicTime now) noexcept {
  const bool was_silent = now - std::exchange(read_at_, now) > kLineSilence;
  if (!was_silent || size_ == 0) return;
  if (!std::exchange(is_behind_silence_, true)) return;
  ++counters_.damaged;
  size_ = 0;
  is_too_long_ = is_behind_silence_ = false;
}

std::optional<std::span<const std::byte>> Deframer::push(std::byte byte) noexcept {
  if (byte == std::byte{0}) return end_of_frame();
  is_behind_two_zeros_ = false;
  if (size_ == stuffed_.size()) {
    // Counted here, for its end may never come: a receiver that is slower than the sender finds no
    // zero in what it hears.
    ++counters_.damaged;
    is_too_long_ = true;
    size_ = 0;
  }
  stuffed_[size_++] = byte;
  return std::nullopt;
}

std::optional<std::span<const std::byte>> Deframer::end_of_frame() noexcept {
  const auto stuffed = std::span(stuffed_).first(size_);
  const bool is_counted = is_too_long_;
  const bool is_nothing = size_ == 0;  // two zeros between two frames
  size_ = 0;
  is_too_long_ = is_behind_silence_ = false;
  // A receiver that is ten times as fast as the sender hears nothing else.
  if (is_nothing && std::exchange(is_behind_two_zeros_, true)) ++counters_.damaged;
  if (is_nothing || is_counted) return std::nullopt;
  const std::optional<std::size_t> size = unstuff(stuffed, plain_);
  if (size && *size > kSerialChecksum && *size <= kMaxFramed) {
    const auto datagram = std::span<const std::byte>(plain_).first(*size - kSerialChecksum);
    std::uint32_t sum = 0;
    ByteReader(std::span<const std::byte>(plain_).subspan(datagram.size(), kSerialChecksum))
        .values(sum);
    if (sum == crc32(datagram)) {
      ++counters_.frames;
      return datagram;
    }
  }
  ++counters_.damaged;
  return std::nullopt;
}

void LinePace::on_sent(std::size_t bytes, MonotonicTime now) noexcept {
  constexpr std::uint64_t kBitsPerByte = 10;
  const std::uint64_t nanobits = kBitsPerByte * bytes * 1'000'000'000U;
  const auto time = Duration(static_cast<Duration::rep>((nanobits + bit_per_s_ - 1) / bit_per_s_));
  free_at_ = std::max(free_at_, now) + time;
}

}  // namespace thimble::link
