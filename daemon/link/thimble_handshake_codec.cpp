#include <algorithm>
#include <string_view>

#include "daemon/link/thimble_codec.hpp"
#include "daemon/link/thimble_codec_parts.hpp"

namespace thimble::link {
using namespace codec;
namespace {

constexpr std::uint16_t kSealedFlag = 1;
// Ours: a thousand times the longest edge of a world; a metre is its coarsest cell.
constexpr std::uint32_t kMaxCells = 1U << 20U;
constexpr double kMaxCell_m = 1;

bool is_letter(char c) noexcept {
  return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
}
// Nothing but letters before the first zero, and nothing but zeros behind.
Reason check_name(const ShortName& name) noexcept {
  const auto end = std::find(name.letters.begin(), name.letters.end(), '\0');
  const bool is_name = std::all_of(name.letters.begin(), end, is_letter) &&
                       std::all_of(end, name.letters.end(), [](char c) { return c == '\0'; });
  return unless(is_name, RejectReason::Malformed);
}

template <class Bytes, class Name>
void carry_name(Bytes& b, Name& name) noexcept {
  if constexpr (Bytes::kIsReader) {
    b.block(std::as_writable_bytes(std::span(name.letters)));
  } else {
    b.block(std::as_bytes(std::span(name.letters)));
  }
}

template <class Bytes, class Message>
bool carry_hello(Bytes& b, Message& m) noexcept {
  carry_timing(b, m.timing);
  b.block(m.arm_nonce);
  b.block(m.world_nonce);
  auto& half = m.half;
  carry_name(b, half.scheme);
  b.values(half.force_at, half.zone_names, half.buffer_m, m.capabilities);
  return true;
}

template <class Bytes, class Message>
bool carry_challenge(Bytes& b, Message& m) noexcept {
  carry_timing(b, m.timing);
  b.block(m.arm_nonce);
  b.block(m.world_nonce);
  return false;
}

template <class Bytes, class Message>
bool carry_welcome(Bytes& b, Message& m) noexcept {
  carry_timing(b, m.timing);
  b.block(m.arm_nonce);
  b.values(m.capabilities);
  carry_name(b, m.world);
  b.values(m.cells, m.cell_m, m.epoch);
  return true;
}

template <class Bytes, class Message>
bool carry_refusal(Bytes& b, Message& m) noexcept {
  carry_timing(b, m.timing);
  b.block(m.arm_nonce);
  auto reason = static_cast<std::uint8_t>(m.reason);
  b.values(reason);
  if constexpr (Bytes::kIsReader) m.reason = static_cast<ThimbleRefusalReason>(reason);
  if constexpr (Bytes::kIsReader) m.scheme = {};
  if (m.reason == ThimbleRefusalReason::Arm) carry_name(b, m.scheme);
  return false;
}

bool is_known_kind(ThimbleKind kind) noexcept {
  switch (kind) {
    case ThimbleKind::Hello:
    case ThimbleKind::Challenge:
    case ThimbleKind::Welcome:
    case ThimbleKind::Refusal:
    case ThimbleKind::Sample:
    case ThimbleKind::Constraints:
    case ThimbleKind::Idle:
      return true;
  }
  return false;
}

}  // namespace

// Found by encode_as() and decode_as() through the messages' namespace.
static bool carry(ByteWriter& b, const ThimbleHello& m) noexcept { return carry_hello(b, m); }
static bool carry(ByteReader& b, ThimbleHello& m) noexcept { return carry_hello(b, m); }
static bool carry(ByteWriter& b, const ThimbleChallenge& m) noexcept {
  return carry_challenge(b, m);
}
static bool carry(ByteReader& b, ThimbleChallenge& m) noexcept { return carry_challenge(b, m); }
static bool carry(ByteWriter& b, const ThimbleWelcome& m) noexcept { return carry_welcome(b, m); }
static bool carry(ByteReader& b, ThimbleWelcome& m) noexcept { return carry_welcome(b, m); }
static bool carry(ByteWriter& b, const ThimbleRefusal& m) noexcept { return carry_refusal(b, m); }
static bool carry(ByteReader& b, ThimbleRefusal& m) noexcept { return carry_refusal(b, m); }
static Reason check(const ThimbleHello& m) noexcept {
  const ThimbleHalf& half = m.half;
  return first_of(check_timing(m.timing), check_name(half.scheme),
                  unless(half.force_at <= 1 && half.zone_names <= 1, RejectReason::Malformed),
                  check_reach(half.buffer_m), unless(half.buffer_m >= 0, RejectReason::OutOfRange));
}

static Reason check(const ThimbleChallenge& m) noexcept { return check_timing(m.timing); }
static Reason check(const ThimbleWelcome& m) noexcept {
  const bool are_cells = std::all_of(m.cells.begin(), m.cells.end(),
                                     [](std::uint32_t edge) { return edge <= kMaxCells; });
  const bool is_cell = m.cell_m >= 0 && m.cell_m <= kMaxCell_m;  // NaN is not
  return first_of(check_timing(m.timing), check_name(m.world), check_finite(m.cell_m),
                  unless(are_cells && is_cell, RejectReason::OutOfRange));
}

static Reason check(const ThimbleRefusal& m) noexcept {
  const bool is_known =
      m.reason >= ThimbleRefusalReason::Busy && m.reason <= ThimbleRefusalReason::Arm;
  return first_of(check_timing(m.timing), check_name(m.scheme),
                  unless(is_known, RejectReason::Malformed));
}

ShortName ShortName::of(std::string_view text) noexcept {
  ShortName name;
  std::copy_n(text.begin(), std::min(text.size(), kSize), name.letters.begin());
  return name;
}

std::string_view ShortName::view() const noexcept {
  const auto end = std::find(letters.begin(), letters.end(), '\0');
  return {letters.data(), static_cast<std::size_t>(end - letters.begin())};
}

bool is_thimble_datagram(std::span<const std::byte> bytes) noexcept {
  if (bytes.size() < kThimbleHeaderSize) return false;
  std::uint32_t magic = 0;
  ByteReader(bytes).values(magic);
  return magic == kThimbleMagic;
}

void encode_header(const ThimbleHeader& header,
                   std::span<std::byte, kThimbleHeaderSize> out) noexcept {
  ByteWriter writer(out);
  writer.values(kThimbleMagic, kThimbleVersion, static_cast<std::uint8_t>(header.kind),
                header.is_sealed ? kSealedFlag : std::uint16_t{0}, header.session, header.sequence);
}

Decoded<ThimbleHeader> decode_header(std::span<const std::byte> bytes) noexcept {
  if (bytes.size() < kThimbleHeaderSize || bytes.size() > kMaxThimbleDatagram) {
    return tl::unexpected(RejectReason::WrongSize);
  }
  ByteReader reader(bytes);
  std::uint32_t magic = 0;
  std::uint8_t version = 0;
  std::uint8_t kind = 0;
  std::uint16_t flags = 0;
  ThimbleHeader header;
  reader.values(magic, version, kind, flags, header.session, header.sequence);
  header.kind = static_cast<ThimbleKind>(kind);
  header.is_sealed = flags == kSealedFlag;
  const bool is_known = magic == kThimbleMagic && version == kThimbleVersion &&
                        flags <= kSealedFlag && is_known_kind(header.kind);
  if (!is_known) return tl::unexpected(RejectReason::WrongVersion);
  return header;
}

Decoded<std::size_t> encode(const ThimbleHello& message,
                            std::span<std::byte, kMaxThimbleContent> out) noexcept {
  return encode_as(message, out);
}
Decoded<std::size_t> encode(const ThimbleChallenge& message,
                            std::span<std::byte, kMaxThimbleContent> out) noexcept {
  return encode_as(message, out);
}
Decoded<std::size_t> encode(const ThimbleWelcome& message,
                            std::span<std::byte, kMaxThimbleContent> out) noexcept {
  return encode_as(message, out);
}
Decoded<std::size_t> encode(const ThimbleRefusal& message,
                            std::span<std::byte, kMaxThimbleContent> out) noexcept {
  return encode_as(message, out);
}

Decoded<void> decode(std::span<const std::byte> content, ThimbleHello& out) noexcept {
  return decode_as(content, out);
}
Decoded<void> decode(std::span<const std::byte> content, ThimbleChallenge& out) noexcept {
  return decode_as(content, out);
}
Decoded<void> decode(std::span<const std::byte> content, ThimbleWelcome& out) noexcept {
  return decode_as(content, out);
}
Decoded<void> decode(std::span<const std::byte> content, ThimbleRefusal& out) noexcept {
  return decode_as(content, out);
}

}  // namespace thimble::link
