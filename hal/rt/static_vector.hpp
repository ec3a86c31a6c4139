#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <type_traits>

namespace thimble::rt {

// Bounded container for servo data and messages: trivially copyable, so it crosses threads
// through the wait-free buffers. push_back() on a full one returns false and changes nothing.
template <class T, std::size_t Capacity>
class StaticVector {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  constexpr bool push_back(const T& value) noexcept {
    if (size_ == Capacity) return false;
    items_[size_++] = value;
    return true;
  }
  constexpr void clear() noexcept { size_ = 0; }
  [[nodiscard]] constexpr std::size_t size() const noexcept { return size_; }
  [[nodiscard]] constexpr bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] static constexpr std::size_t capacity() noexcept { return Capacity; }
  constexpr T& operator[](std::size_t i) noexcept { return items_[i]; }
  constexpr const T& operator[](std::size_t i) const noexcept { return items_[i]; }
  constexpr auto begin() noexcept { return items_.begin(); }
  constexpr auto end() noexcept { return items_.begin() + static_cast<std::ptrdiff_t>(size_); }
  constexpr auto begin() const noexcept { return items_.begin(); }
  constexpr auto end() const noexcept {
    return items_.begin() + static_cast<std::ptrdiff_t>(size_);
  }
  constexpr operator std::span<const T>() const noexcept { return {items_.data(), size_}; }
  friend constexpr bool operator==(const StaticVector& a, const StaticVector& b) noexcept {
    if (a.size_ != b.size_) return false;
    for (std::size_t i = 0; i < a.size_; ++i) {
      if (!(a.items_[i] == b.items_[i])) return false;
    }
    return true;
  }

 private:
  std::array<T, Capacity> items_{};
  std::size_t size_{0};
};

}  // namespace thimble::rt
