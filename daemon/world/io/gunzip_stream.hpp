#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "daemon/world/io/buffered_source.hpp"
#include "hal/base/result.hpp"

namespace thimble::world {

// deflate cannot do better: a match of 258 bytes takes at least 2 bits.
// SOURCE: zlib's technical notes, "Maximum Compression Factor", 1032:1.
inline constexpr std::uint64_t kMaxGunzipRatio = 1032;

// The bytes that the rest of `packed` holds in gzip's format (RFC 1952), members one after another.
//
// Thread: one. Not RT. Ownership: `packed` must outlive it. Holds about 50 KiB beside the buffer of
// `packed`. Errors: Malformed for what is not gzip, is damaged (each member's checksum is
// compared) or ends early; System when zlib gets no memory.
class GunzipStream final : public ByteStream {
 public:
  explicit GunzipStream(BufferedSource& packed);
  ~GunzipStream() override;
  GunzipStream(const GunzipStream&) = delete;
  GunzipStream& operator=(const GunzipStream&) = delete;

  [[nodiscard]] Result<std::size_t> read(std::span<std::byte> out) override;

 private:
  struct State;
  [[nodiscard]] Result<bool> begin_member();

  BufferedSource& packed_;
  std::unique_ptr<State> state_;
};

}  // namespace thimble::world
