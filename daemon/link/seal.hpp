#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "daemon/link/link_key.hpp"
#include "daemon/link/thimble_codec.hpp"

namespace thimble::link {

// Fills with what nobody can guess. Injected, so that virtual time has the same trace twice.
using RandomBytes = std::function<void(std::span<std::byte>)>;
[[nodiscard]] RandomBytes system_random();

// BLAKE2b with 32 bytes, keyed.
[[nodiscard]] Nonce keyed_sum(const LinkKey& key, std::span<const std::byte> text) noexcept;

enum class Towards : std::uint8_t { World, Arm };

// A datagram on its way, header first. Beyond `size` its bytes mean nothing: to zero the room costs
// as much as to fill it.
struct ThimbleDatagram {
  ThimbleDatagram() noexcept {}

  std::array<std::byte, kMaxThimbleDatagram> bytes;
  std::size_t size{0};
  [[nodiscard]] std::span<const std::byte> view() const noexcept {
    return std::span(bytes).first(size);
  }
};

// Seals the datagrams of one direction, or opens them: authenticated and encrypted, the header
// authenticated (libsodium; decision 0425). Without a key it is none, and takes only what is not
// sealed; with one it takes nothing else.
//
//   handshake  XChaCha20-Poly1305, key for ever, nonce of 24 random bytes behind the header
//   session    ChaCha20-Poly1305 (RFC 8439), key of one session, nonce the header's sequence
//
// Keys of both directions: BLAKE2b with 64 bytes, keyed by the link's key, of "thimble 1
// handshake", or of "thimble 1 session", the arm's nonce, the world's and the session (8 bytes,
// network order); the first half is towards the world.
//
// Thread: any, one at a time. RT: no allocation, no system call but for random(). Errors: open():
// BadSeal, WrongSize. The owner of a session's keys must not use a sequence twice.
class Seal {
 public:
  Seal() noexcept = default;  // none
  [[nodiscard]] static Seal of_handshake(const LinkKey& key, Towards towards) noexcept;
  [[nodiscard]] static Seal of_session(const LinkKey& key, Towards towards, const Nonce& arm,
                                       const Nonce& world, std::uint64_t session) noexcept;
  ~Seal();
  Seal(const Seal&) = default;
  Seal& operator=(const Seal&) = default;

  // Header, message and tag into `out`. `header.is_sealed` is set as it is. `random` only in a
  // handshake with a key. Reasons: as encode().
  template <class Message>
  [[nodiscard]] Decoded<void> pack(ThimbleHeader header, const Message& message,
                                   const RandomBytes& random, ThimbleDatagram& out) const {
    header.is_sealed = kind_ != Kind::None;
    const std::span<std::byte, kMaxThimbleDatagram> bytes(out.bytes);
    encode_header(header, bytes.first<kThimbleHeaderSize>());
    const std::size_t begin = content_begin();
    const std::span<std::byte, kMaxThimbleContent> room(out.bytes.data() + begin,
                                                        kMaxThimbleContent);
    const Decoded<std::size_t> size = encode(message, room);
    if (!size) return tl::unexpected(size.error());
    close(header, *size, random, out);
    return {};
  }

  // The content of a datagram with that header, in `room` where it was sealed; nobody has to zero
  // that.
  [[nodiscard]] Decoded<std::span<const std::byte>> open(
      const ThimbleHeader& header, std::span<const std::byte> datagram,
      std::span<std::byte, kMaxThimbleContent> room) const noexcept;

  [[nodiscard]] bool has_key() const noexcept { return kind_ != Kind::None; }

 private:
  enum class Kind : std::uint8_t { None, Handshake, Session };
  static constexpr std::size_t kKeySize = 32;

  Seal(Kind kind, std::span<const std::byte, kKeySize> key) noexcept;
  [[nodiscard]] std::size_t content_begin() const noexcept;
  void close(const ThimbleHeader& header, std::size_t content_size, const RandomBytes& random,
             ThimbleDatagram& out) const;

  Kind kind_{Kind::None};
  std::array<std::byte, kKeySize> key_{};
};

}  // namespace thimble::link
