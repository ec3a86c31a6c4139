#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "daemon/coupling/messages.hpp"
#include "daemon/link/link_counters.hpp"
#include "hal/base/geometry.hpp"
#include "hal/base/result.hpp"

namespace thimble::link {

// The datagrams of 1999, byte for byte (thesis appendices A and B). The only place in the
// house where millimetres exist.
//
// Request, arm to world, 12 bytes: x, y, z as binary32, big-endian, mm, world frame.
// Reply, world to arm, 13 bytes: the positions of up to three planes, one an axis, likewise,
// and a byte of directions: bit 0 "x <", 1 "x >", 2 "y <", 3 "y >", 4 "z <", 5 "z >". The hand
// is to stay on the named side of the plane. The position of an axis without a bit is
// garbage by that protocol, NaN included: it is never looked at.
//
// Thread: any. RT: pure, allocation-free. Errors: total, any bytes give a value or a reason.
inline constexpr std::size_t kThesisRequestSize = 12;
inline constexpr std::size_t kThesisReplySize = 13;
using ThesisRequest = std::array<std::byte, kThesisRequestSize>;
using ThesisReply = std::array<std::byte, kThesisReplySize>;

// Positions beyond are refused: the largest arm known reaches 0.5 m (arms.md), so these are
// not positions but noise. Ours.
inline constexpr double kMaxThesisCoordinate_m = 10.0;

template <class T>
using Decoded = tl::expected<T, RejectReason>;

// A hand beyond the limit is said to be at it: an arm end that fell silent for it would lose
// its constraints. Reasons: NonFinite.
[[nodiscard]] Decoded<ThesisRequest> encode_thesis_request(Position3 hand) noexcept;
// Reasons: WrongSize, NonFinite, OutOfRange.
[[nodiscard]] Decoded<Position3> decode_thesis_request(std::span<const std::byte> bytes) noexcept;

struct EncodedReply {
  ThesisReply bytes{};
  std::uint32_t unencodable{0};  // planes not along an axis, non-finite or beyond 10 m
};

// As the server of 1999 would say it to a hand at `hand`: only planes that the hand has
// passed, the innermost of each axis. Cells there own their lower boundary, so a hand exactly on an
// upper wall ("<") has passed it and one exactly on a lower wall (">") has not. Axes
// without a plane are sent as 0.0. Compared in binary32, as the hand arrived.
[[nodiscard]] EncodedReply encode_thesis_reply(Position3 hand,
                                               const coupling::PlaneList& planes) noexcept;
// Reasons: WrongSize, BadDirection, NonFinite, OutOfRange. Planes in the order x, y, z.
[[nodiscard]] Decoded<coupling::PlaneList> decode_thesis_reply(
    std::span<const std::byte> bytes) noexcept;

}  // namespace thimble::link
