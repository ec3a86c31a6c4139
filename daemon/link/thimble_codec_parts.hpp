#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>

#include "daemon/link/network_bytes.hpp"
#include "daemon/link/thimble_codec.hpp"

// Only for the .cpp files of thimble_codec.hpp: what its messages have in common.

namespace thimble::link::codec {

using Reason = std::optional<RejectReason>;

// One after the other, without a list of them in memory: half of what a codec costs are its checks.
template <class... Reasons>
[[nodiscard]] Reason first_of(const Reason& first, const Reasons&... others) noexcept {
  if constexpr (sizeof...(others) == 0) {
    return first;
  } else {
    return first ? first : first_of(others...);
  }
}
[[nodiscard]] inline Reason unless(bool is_sound, RejectReason reason) noexcept {
  return is_sound ? Reason() : reason;
}

[[nodiscard]] inline Reason check_time(MonotonicTime time) noexcept {
  return unless(time.since_epoch >= Duration::zero() && time.since_epoch <= kMaxThimbleTime,
                RejectReason::OutOfRange);
}
[[nodiscard]] inline Reason check_timing(const ThimbleTiming& timing) noexcept {
  return first_of(check_time(timing.sent_at), check_time(timing.echo),
                  check_time(timing.echoed_at));
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
  return first_of(check_reach(place.x), check_reach(place.y), check_reach(place.z));
}
[[nodiscard]] inline Reason check_waves(const coupling::WaveSums& waves) noexcept {
  return first_of(check_finite(waves.distance), check_finite(waves.joule[0]),
                  check_finite(waves.joule[1]), check_finite(waves.joule[2]));
}
[[nodiscard]] inline Reason check_tool(const coupling::ToolProperties& tool) noexcept {
  return first_of(check_finite(tool.stiffness.newton_per_m),
                  check_finite(tool.damping.newton_s_per_m));
}

// Ours: a thousand times the longest edge of a world.
inline constexpr std::int32_t kMaxCellIndex = 1 << 20;

[[nodiscard]] inline Reason check_lattice(const world::CellLattice& lattice,
                                          const world::Cell& middle) noexcept {
  const auto is_index = [](std::int64_t index) {
    return index >= -kMaxCellIndex && index <= kMaxCellIndex;
  };
  const auto& cells = lattice.cells;
  const bool is_good = is_index(middle.x) && is_index(middle.y) && is_index(middle.z) &&
                       std::all_of(cells.begin(), cells.end(), is_index);
  return first_of(check_reach(lattice.half_cell_m),
                  unless(is_good && lattice.half_cell_m >= 0, RejectReason::OutOfRange));
}

// Fields that a mask says or not. A reader makes of what is not said what it means: 0, or for what
// is known from 0 on, below.
template <class Bytes, class... Values>
void carry_said(Bytes& b, bool are_said, Values&... values) noexcept {
  if (are_said) return b.values(values...);
  if constexpr (Bytes::kIsReader) ((values = Values{}), ...);
}
template <class Bytes, class Value>
void carry_known(Bytes& b, bool is_known, Value& value) noexcept {
  if (is_known) return b.values(value);
  if constexpr (Bytes::kIsReader) value = -1;
}

template <class Bytes, class Timing>
void carry_timing(Bytes& b, Timing& timing) noexcept {
  b.values(timing.sent_at, timing.echo, timing.echoed_at);
}

// Whether a grid can be so is for who moves a ghost through it: world::is_sound() and its like.
template <class Bytes, class Lattice, class Place>
void carry_lattice(Bytes& b, Lattice& lattice, Place& cell) noexcept {
  b.values(lattice.cells, lattice.half_cell_m, cell);
}
template <class Bytes, class Flag>
void carry_flag(Bytes& b, Flag& is_set) noexcept {
  std::uint8_t bit = is_set ? 1 : 0;
  b.values(bit);
  if constexpr (Bytes::kIsReader) {
    is_set = bit == 1;
    if (bit > 1) b.refuse();
  }
}
// How many there are; a reader makes room for them.
template <class Bytes, class List>
void carry_count(Bytes& b, List& list) noexcept {
  auto count = static_cast<std::uint8_t>(list.size());
  b.values(count);
  if constexpr (Bytes::kIsReader) {
    list.clear();
    for (std::size_t i = 0; i < count && b.is_good(); ++i) {
      if (!list.push_back({})) return b.refuse();
    }
  }
}

template <class Bytes, class Near>
void carry_near(Bytes& b, Near& near) noexcept {
  carry_lattice(b, near.lattice, near.middle);
  b.values(near.known.first, near.known.last);
  carry_flag(b, near.is_plane);
  carry_count(b, near.boxes);
  for (auto& box : near.boxes) b.values(box.first, box.last);
}

template <class Bytes, class Map>
void carry_map(Bytes& b, Map& map) noexcept {
  carry_lattice(b, map.lattice, map.ghost_cell);
  carry_flag(b, map.is_plane);
  carry_count(b, map.blocks);
  for (auto& block : map.blocks) b.values(block.at, block.version, block.slices);
}

// Both halves of a message. Of its own it has, in the namespace of the link: carry() with a writer
// and with a reader, which says whether more may follow than is known; and check(). The reader's
// writes every field that means something, so that `out` may have held any other message.
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
