#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "daemon/world/io/byte_source.hpp"
#include "hal/base/result.hpp"

namespace thimble::world {

// What is left of a source, with a look ahead: for headers whose length only they tell.
//
// Thread: one. Not RT. Ownership: `inner` must outlive it. Holds 64 KiB. Errors: the inner one's.
class BufferedSource final : public ByteSource {
 public:
  static constexpr std::size_t kAhead = 65536;

  explicit BufferedSource(ByteSource& inner) : inner_(inner), left_(inner.size()) {}

  // Bytes not taken yet.
  [[nodiscard]] std::uint64_t size() const noexcept override { return left_; }
  [[nodiscard]] Result<std::size_t> read(std::span<std::byte> out) override;
  // The next bytes, at least one until the end: kAhead of them on the first call.
  [[nodiscard]] Result<std::span<const std::byte>> peek();
  // Takes bytes that peek() showed.
  void take(std::size_t count) noexcept;
  // Takes up to `count` bytes; the number says how many there were.
  [[nodiscard]] Result<std::uint64_t> skip(std::uint64_t count);

 private:
  ByteSource& inner_;
  std::uint64_t left_;
  std::vector<std::byte> buffer_{};
  std::size_t start_{0};
};

}  // namespace thimble::world
