#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>

#include "hal/base/geometry.hpp"
#include "hal/base/time.hpp"

namespace thimble::link {

// Writer and reader of one datagram, in network byte order. They have the same functions, so that a
// list of fields stands once and serves both ways: what is written cannot be read in another order.
//
// Thread: one. RT: pure, allocation-free. Ownership: the span must outlive them.
// Errors: beyond the end nothing is touched and is_good() is false from then on; what is read there
// is 0.

static_assert(std::numeric_limits<double>::is_iec559 && sizeof(double) == 8);

template <std::unsigned_integral Word>
[[nodiscard]] constexpr Word in_network_order(Word word) noexcept {
  if constexpr (std::endian::native == std::endian::big || sizeof(Word) == 1) return word;
  if constexpr (sizeof(Word) == 2) return __builtin_bswap16(word);
  if constexpr (sizeof(Word) == 4) return __builtin_bswap32(word);
  if constexpr (sizeof(Word) == 8) return __builtin_bswap64(word);
}

class ByteWriter {
 public:
  static constexpr bool kIsReader = false;
  explicit ByteWriter(std::span<std::byte> out) noexcept : out_(out) {}

  template <std::unsigned_integral Word>
  void word(Word value) noexcept {
    const Word ordered = in_network_order(value);
    is_good_ = is_good_ && sizeof ordered <= out_.size() - size_;
    if (!is_good_) return;
    std::memcpy(out_.data() + size_, &ordered, sizeof ordered);
    size_ += sizeof ordered;
  }
  void integer(std::int32_t value) noexcept { word(std::bit_cast<std::uint32_t>(value)); }
  void real(double value) noexcept { word(std::bit_cast<std::uint64_t>(value)); }
  void time(MonotonicTime value) noexcept {
    word(static_cast<std::uint64_t>(value.since_epoch.count()));
  }
  template <class Vector>
  void vector(const Vector& value) noexcept {
    for (const double component : {value.x, value.y, value.z}) real(component);
  }
  void block(std::span<const std::byte> bytes) noexcept {
    is_good_ = is_good_ && bytes.size() <= out_.size() - size_;
    if (!is_good_) return;
    std::memcpy(out_.data() + size_, bytes.data(), bytes.size());
    size_ += bytes.size();
  }

  [[nodiscard]] bool is_good() const noexcept { return is_good_; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }

 private:
  std::span<std::byte> out_;
  std::size_t size_{0};
  bool is_good_{true};
};

class ByteReader {
 public:
  static constexpr bool kIsReader = true;
  explicit ByteReader(std::span<const std::byte> in) noexcept : in_(in) {}

  template <std::unsigned_integral Word>
  void word(Word& value) noexcept {
    Word ordered{0};
    is_good_ = is_good_ && sizeof ordered <= in_.size() - position_;
    if (is_good_) {
      std::memcpy(&ordered, in_.data() + position_, sizeof ordered);
      position_ += sizeof ordered;
    }
    value = in_network_order(ordered);
  }
  void integer(std::int32_t& value) noexcept {
    std::uint32_t bits = 0;
    word(bits);
    value = std::bit_cast<std::int32_t>(bits);
  }
  void real(double& value) noexcept {
    std::uint64_t bits = 0;
    word(bits);
    value = std::bit_cast<double>(bits);
  }
  void time(MonotonicTime& value) noexcept {
    std::uint64_t bits = 0;
    word(bits);
    value = {Duration(static_cast<Duration::rep>(bits))};
  }
  template <class Vector>
  void vector(Vector& value) noexcept {
    real(value.x);
    real(value.y);
    real(value.z);
  }
  void block(std::span<std::byte> bytes) noexcept {
    is_good_ = is_good_ && bytes.size() <= in_.size() - position_;
    if (!is_good_) return;
    std::memcpy(bytes.data(), in_.data() + position_, bytes.size());
    position_ += bytes.size();
  }

  // What was read cannot be: nothing is read any more.
  void refuse() noexcept { is_good_ = false, is_refused_ = true; }

  [[nodiscard]] bool is_good() const noexcept { return is_good_; }
  [[nodiscard]] bool is_refused() const noexcept { return is_refused_; }
  [[nodiscard]] std::size_t left() const noexcept { return in_.size() - position_; }

 private:
  std::span<const std::byte> in_;
  std::size_t position_{0};
  bool is_good_{true};
  bool is_refused_{false};
};

}  // namespace thimble::link
