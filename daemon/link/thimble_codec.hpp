#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "daemon/link/link_counters.hpp"
#include "daemon/link/thesis_codec.hpp"
#include "daemon/link/thimble_messages.hpp"

namespace thimble::link {

// The bytes of Thimble's own datagrams (docs/link-protocol.md): a header, which travels in the
// clear, and a content, which a key seals. Network byte order; numbers as binary64, so that the
// link rounds nothing.
//
// Thread: any. RT: pure, allocation-free. Errors: total, any bytes give a value or a reason; where
// there is a reason the output means nothing.

// Ours: what every network carries in one piece, with room for the headers below.
inline constexpr std::size_t kMaxThimbleDatagram = 1200;
inline constexpr std::size_t kThimbleHeaderSize = 24;
inline constexpr std::size_t kMaxSealOverhead = 40;  // nonce of a handshake, and tag
inline constexpr std::size_t kMaxThimbleContent =
    kMaxThimbleDatagram - kThimbleHeaderSize - kMaxSealOverhead;
inline constexpr std::uint32_t kThimbleMagic = 0x54484D42;  // "THMB"
inline constexpr std::uint8_t kThimbleVersion = 1;

// Times beyond are refused, that of two of them a sum or difference is always a time: 73 years.
inline constexpr Duration kMaxThimbleTime{std::int64_t{1} << 61};

// Whether these bytes are meant for this protocol, whatever is wrong with them. The datagrams of
// 1999 are never: they are shorter than a header.
[[nodiscard]] bool is_thimble_datagram(std::span<const std::byte> bytes) noexcept;

void encode_header(const ThimbleHeader& header,
                   std::span<std::byte, kThimbleHeaderSize> out) noexcept;
// Reasons: WrongSize, WrongVersion.
[[nodiscard]] Decoded<ThimbleHeader> decode_header(std::span<const std::byte> bytes) noexcept;

// The bytes written. Reasons: NonFinite, OutOfRange (a place beyond kMaxThesisCoordinate_m, a time
// that cannot be), BadDirection, Malformed. A hand beyond the limit is said to be at it, as to
// programs of 1999.
[[nodiscard]] Decoded<std::size_t> encode(const ThimbleSample& message,
                                          std::span<std::byte, kMaxThimbleContent> out) noexcept;
[[nodiscard]] Decoded<std::size_t> encode(const ThimbleConstraints& message,
                                          std::span<std::byte, kMaxThimbleContent> out) noexcept;
[[nodiscard]] Decoded<std::size_t> encode(const ThimbleIdle& message,
                                          std::span<std::byte, kMaxThimbleContent> out) noexcept;
[[nodiscard]] Decoded<std::size_t> encode(const ThimbleHello& message,
                                          std::span<std::byte, kMaxThimbleContent> out) noexcept;
[[nodiscard]] Decoded<std::size_t> encode(const ThimbleChallenge& message,
                                          std::span<std::byte, kMaxThimbleContent> out) noexcept;
[[nodiscard]] Decoded<std::size_t> encode(const ThimbleWelcome& message,
                                          std::span<std::byte, kMaxThimbleContent> out) noexcept;
[[nodiscard]] Decoded<std::size_t> encode(const ThimbleRefusal& message,
                                          std::span<std::byte, kMaxThimbleContent> out) noexcept;

// `out` may have held another message: nothing of that is left but behind a has_far, has_near or
// has_map that is false, and where there is a reason. Reasons: those, and WrongSize.
[[nodiscard]] Decoded<void> decode(std::span<const std::byte> content, ThimbleSample& out) noexcept;
[[nodiscard]] Decoded<void> decode(std::span<const std::byte> content,
                                   ThimbleConstraints& out) noexcept;
[[nodiscard]] Decoded<void> decode(std::span<const std::byte> content, ThimbleIdle& out) noexcept;
[[nodiscard]] Decoded<void> decode(std::span<const std::byte> content, ThimbleHello& out) noexcept;
[[nodiscard]] Decoded<void> decode(std::span<const std::byte> content,
                                   ThimbleChallenge& out) noexcept;
[[nodiscard]] Decoded<void> decode(std::span<const std::byte> content,
                                   ThimbleWelcome& out) noexcept;
[[nodiscard]] Decoded<void> decode(std::span<const std::byte> content,
                                   ThimbleRefusal& out) noexcept;

}  // namespace thimble::link
