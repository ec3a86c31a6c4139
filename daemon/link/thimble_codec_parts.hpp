#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "daemon/link/network_bytes.hpp"
#include "daemon/link/thimble_codec.hpp"

// Only for the .cpp files of thimble_codec.hpp: what its messages have in common.

namespace thimble::link::codec {

using Reason = std::optional<RejectReason>;

[[nodiscard]] inline Reason first_of(std::initializer_list<Reason> reasons) noexcept {
  for (const Reason& reason : reasons) {
    if (reason) return reason;
  }
  return std::nullopt;
}
[[nodiscard]] inline Reason unless(bool is_sound, RejectReason reason) noexcept {
  return is_sound ? Reason() : reason;
}

[[nodiscard]] inline Reason check_time(MonotonicTime time) noexcept {
  return unless(time.since_epoch >= Duration::zero() && time.since_epoch <= kMaxThimbleTime,
                RejectReason::OutOfRange);
}
[[nodiscard]] inline Reason check_timing(const ThimbleTiming& timing) noexcept {
  return first_of(
      {check_time(timing.sent_at), check_time(timing.echo), check_time(timing.echoed_at)});
}
[[nodiscard]] inline Reason check_finite(double value) noexcept {
  return unless(std::isfinite(value), RejectReason::NonFinite);
}
template <class Quantity>
[[nodiscard]] Reason check_finite(const Vector3<Quantity>& value) noexcept {
  return unless(is_finite(value), RejectReason::NonFinite);
}
// Along one axis, or from the origin along a normal.
[[nodiscard]] inline Reason check_reach(double value_m) noexcept {
  if (!std::isfinite(value_m)) return RejectReason::NonFinite;
  return unless(std::abs(value_m) <= kMaxThesisCoordinate_m, RejectReason::OutOfRange);
}
[[nodiscard]] inline Reason check_place(Position3 place) noexcept {
  return first_of({check_reach(place.x), check_reach(place.y), check_reach(place.z)});
}
[[nodiscard]] inline Reason check_waves(const coupling::WaveSums& waves) noexcept {
  return first_of({check_finite(waves.distance), check_finite(waves.joule[0]),
                   check_finite(waves.joule[1]), check_finite(waves.joule[2])});
}

template <class Bytes, class Timing>
void carry_timing(Bytes& bytes, Timing& timing) noexcept {
  bytes.time(timing.sent_at);
  bytes.time(timing.echo);
  bytes.time(timing.echoed_at);
}
template <class Bytes, class Waves>
void carry_waves(Bytes& bytes, Waves& waves) noexcept {
  bytes.vector(waves.distance);
  for (auto& joule : waves.joule) bytes.real(joule);
}
template <class Bytes, class Words>
void carry_words(Bytes& bytes, Words& words) noexcept {
  for (auto& word : words) bytes.word(word);
}
template <class Bytes, class Cell>
void carry_cell(Bytes& bytes, Cell& cell) noexcept {
  for (auto& index : cell) bytes.integer(index);
}

// Calls carry_value(*field) where the field is said; a reader makes it first.
template <class Bytes, class Field, class Carry>
void carry_optional(bool is_said, Field& field, const Carry& carry_value) noexcept {
  if (!is_said) return;
  if constexpr (Bytes::kIsReader) field.emplace();
  carry_value(*field);
}

// Both halves of a message. Of its own it has, in the namespace of the link: carry() with a writer
// and with a reader, which says whether more may follow than is known; and check().
template <class Message>
[[nodiscard]] Decoded<std::size_t> encode_as(const Message& message,
                                             std::span<std::byte> out) noexcept {
  if (const Reason reason = check(message)) return tl::unexpected(*reason);
  ByteWriter writer(out);
  carry(writer, message);
  if (!writer.is_good()) return tl::unexpected(RejectReason::WrongSize);
  return writer.size();
}
template <class Message>
[[nodiscard]] Decoded<void> decode_as(std::span<const std::byte> content, Message& out) noexcept {
  out = Message();
  ByteReader reader(content);
  const bool may_go_on = carry(reader, out);
  if (reader.is_refused()) return tl::unexpected(RejectReason::Malformed);
  if (!reader.is_good() || (reader.left() > 0 && !may_go_on)) {
    return tl::unexpected(RejectReason::WrongSize);
  }
  if (const Reason reason = check(out)) return tl::unexpected(*reason);
  return {};
}

}  // namespace thimble::link::codec
