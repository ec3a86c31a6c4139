#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <type_traits>

#include "hal/base/geometry.hpp"
#include "hal/base/time.hpp"

namespace thimble::link {

// Writer and reader of one datagram, in network byte order. They have the same functions, so that a
// list of fields stands once and serves both ways: what is written cannot be read in another order.
// What values() takes together is together there or not: one look whether there is room, which
// costs as much as a word itself.
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

// Integers but bool, numbers and times: what stands there as one word.
template <class T>
concept NetworkWord = (std::integral<T> && !std::same_as<T, bool>) || std::same_as<T, double> ||
                      std::same_as<T, MonotonicTime>;
// Vectors and cells.
template <class T>
concept NetworkAxes = requires(T value) {
  value.x;
  value.y;
  value.z;
};

template <class T>
inline constexpr std::size_t kNetworkSize = sizeof(T);
template <NetworkAxes T>
inline constexpr std::size_t kNetworkSize<T> = 3 * sizeof(T::x);
template <class T, std::size_t N>
inline constexpr std::size_t kNetworkSize<std::array<T, N>> = N* kNetworkSize<T>;

namespace network {

template <std::size_t Size>
using WordOf = std::conditional_t<
    Size == 1, std::uint8_t,
    std::conditional_t<Size == 2, std::uint16_t,
                       std::conditional_t<Size == 4, std::uint32_t, std::uint64_t>>>;

// Behind the last byte of it.
template <NetworkWord T>
std::byte* store(const T& value, std::byte* to) noexcept {
  const auto ordered = in_network_order(std::bit_cast<WordOf<sizeof(T)>>(value));
  std::memcpy(to, &ordered, sizeof ordered);
  return to + sizeof ordered;
}
template <NetworkAxes T>
std::byte* store(const T& value, std::byte* to) noexcept {
  return store(value.z, store(value.y, store(value.x, to)));
}
template <class T, std::size_t N>
std::byte* store(const std::array<T, N>& value, std::byte* to) noexcept {
  if constexpr (sizeof(T) == 1) {
    std::memcpy(to, value.data(), N);
    return to + N;
  } else {
    for (const T& item : value) to = store(item, to);
    return to;
  }
}

template <NetworkWord T>
const std::byte* load(T& value, const std::byte* from) noexcept {
  WordOf<sizeof(T)> ordered{};
  std::memcpy(&ordered, from, sizeof ordered);
  value = std::bit_cast<T>(in_network_order(ordered));
  return from + sizeof ordered;
}
template <NetworkAxes T>
const std::byte* load(T& value, const std::byte* from) noexcept {
  return load(value.z, load(value.y, load(value.x, from)));
}
template <class T, std::size_t N>
const std::byte* load(std::array<T, N>& value, const std::byte* from) noexcept {
  if constexpr (sizeof(T) == 1) {
    std::memcpy(value.data(), from, N);
    return from + N;
  } else {
    for (T& item : value) from = load(item, from);
    return from;
  }
}

}  // namespace network

class ByteWriter {
 public:
  static constexpr bool kIsReader = false;
  explicit ByteWriter(std::span<std::byte> out) noexcept : out_(out) {}

  template <class... Values>
  void values(const Values&... said) noexcept {
    std::byte* to = take((kNetworkSize<Values> + ...));
    if (to == nullptr) return;
    ((to = network::store(said, to)), ...);
  }
  void block(std::span<const std::byte> bytes) noexcept {
    std::byte* const to = take(bytes.size());
    if (to != nullptr && !bytes.empty()) std::memcpy(to, bytes.data(), bytes.size());
  }

  [[nodiscard]] bool is_good() const noexcept { return is_good_; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }

 private:
  // Room for the next ones; nullptr: there is none any more.
  [[nodiscard]] std::byte* take(std::size_t size) noexcept {
    is_good_ = is_good_ && size <= out_.size() - size_;
    if (!is_good_) return nullptr;
    std::byte* const at = out_.data() + size_;
    size_ += size;
    return at;
  }

  std::span<std::byte> out_;
  std::size_t size_{0};
  bool is_good_{true};
};

class ByteReader {
 public:
  static constexpr bool kIsReader = true;
  explicit ByteReader(std::span<const std::byte> in) noexcept : in_(in) {}

  template <class... Values>
  void values(Values&... read) noexcept {
    const std::byte* from = take((kNetworkSize<Values> + ...));
    if (from == nullptr) {
      ((read = Values{}), ...);
      return;
    }
    ((from = network::load(read, from)), ...);
  }
  void block(std::span<std::byte> bytes) noexcept {
    const std::byte* const from = take(bytes.size());
    if (from != nullptr && !bytes.empty()) std::memcpy(bytes.data(), from, bytes.size());
  }

  // What was read cannot be: nothing is read any more.
  void refuse() noexcept { is_good_ = false, is_refused_ = true; }

  [[nodiscard]] bool is_good() const noexcept { return is_good_; }
  [[nodiscard]] bool is_refused() const noexcept { return is_refused_; }
  [[nodiscard]] std::size_t left() const noexcept { return in_.size() - position_; }

 private:
  // The next ones; nullptr: there are not as many.
  [[nodiscard]] const std::byte* take(std::size_t size) noexcept {
    is_good_ = is_good_ && size <= in_.size() - position_;
    if (!is_good_) return nullptr;
    const std::byte* const at = in_.data() + position_;
    position_ += size;
    return at;
  }

  std::span<const std::byte> in_;
  std::size_t position_{0};
  bool is_good_{true};
  bool is_refused_{false};
};

}  // namespace thimble::link
