#include "daemon/link/thesis_codec.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

namespace thimble::link {
namespace {

static_assert(std::numeric_limits<float>::is_iec559 && sizeof(float) == 4);

constexpr double kMmPerM = 1000.0;
constexpr unsigned kKnownBits = 0x3F;
// A unit normal this close to an axis is along it; the rest is rounding.
constexpr double kAxisTolerance = 1e-9;

constexpr unsigned less_bit(std::size_t axis) { return 1U << (2 * axis); }
constexpr unsigned greater_bit(std::size_t axis) { return 2U << (2 * axis); }

void put_float(std::span<std::byte, 4> out, float value) noexcept {
  const auto word = std::bit_cast<std::uint32_t>(value);
  for (unsigned i = 0; i < 4; ++i) out[i] = static_cast<std::byte>(word >> (24 - 8 * i));
}

float get_float(std::span<const std::byte, 4> in) noexcept {
  std::uint32_t word = 0;
  for (const std::byte byte : in) word = (word << 8U) | std::to_integer<std::uint32_t>(byte);
  return std::bit_cast<float>(word);
}

Decoded<double> metres(float value_mm) noexcept {
  if (!std::isfinite(value_mm)) return tl::unexpected(RejectReason::NonFinite);
  const double value_m = static_cast<double>(value_mm) / kMmPerM;
  if (std::abs(value_m) > kMaxThesisCoordinate_m) return tl::unexpected(RejectReason::OutOfRange);
  return value_m;
}

Decoded<float> clamped_millimetres(double value_m) noexcept {
  if (!std::isfinite(value_m)) return tl::unexpected(RejectReason::NonFinite);
  const double bounded_m = std::clamp(value_m, -kMaxThesisCoordinate_m, kMaxThesisCoordinate_m);
  return static_cast<float>(bounded_m * kMmPerM);
}

Decoded<float> millimetres(double value_m) noexcept {
  if (!std::isfinite(value_m)) return tl::unexpected(RejectReason::NonFinite);
  if (std::abs(value_m) > kMaxThesisCoordinate_m) return tl::unexpected(RejectReason::OutOfRange);
  return static_cast<float>(value_m * kMmPerM);
}

struct AxisPlane {
  std::size_t axis{0};
  bool is_upper{false};  // "<": the obstacle lies towards +axis
  float plane_mm{0};
};

std::optional<AxisPlane> along_axis(const coupling::ConstraintPlane& plane) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double along = plane.normal[axis];
    const double rest = std::hypot(plane.normal[(axis + 1) % 3], plane.normal[(axis + 2) % 3]);
    if (!(std::abs(std::abs(along) - 1) <= kAxisTolerance && rest <= kAxisTolerance)) continue;
    const bool is_upper = along > 0;
    const Decoded<float> plane_mm = millimetres(is_upper ? plane.offset_m : -plane.offset_m);
    if (!plane_mm) return std::nullopt;
    return AxisPlane{axis, is_upper, *plane_mm};
  }
  return std::nullopt;
}

// What is known of one axis while the planes are gone through.
struct AxisChoice {
  bool is_set{false};
  bool is_upper{false};
  float plane_mm{0};
  float passed_mm{0};

  void offer(const AxisPlane& plane, float hand_mm) noexcept {
    const float passed = plane.is_upper ? hand_mm - plane.plane_mm : plane.plane_mm - hand_mm;
    const bool is_passed = plane.is_upper ? passed >= 0 : passed > 0;
    if (!is_passed || (is_set && passed <= passed_mm)) return;
    *this = {true, plane.is_upper, plane.plane_mm, passed};
  }
};

}  // namespace

Decoded<ThesisRequest> encode_thesis_request(Position3 hand) noexcept {
  ThesisRequest bytes{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Decoded<float> value_mm = clamped_millimetres(hand[axis]);
    if (!value_mm) return tl::unexpected(value_mm.error());
    put_float(std::span(bytes).subspan(4 * axis).first<4>(), *value_mm);
  }
  return bytes;
}

Decoded<Position3> decode_thesis_request(std::span<const std::byte> bytes) noexcept {
  if (bytes.size() != kThesisRequestSize) return tl::unexpected(RejectReason::WrongSize);
  Position3 hand;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Decoded<double> value_m = metres(get_float(bytes.subspan(4 * axis).first<4>()));
    if (!value_m) return tl::unexpected(value_m.error());
    hand[axis] = *value_m;
  }
  return hand;
}

EncodedReply encode_thesis_reply(Position3 hand, const coupling::PlaneList& planes) noexcept {
  EncodedReply reply;
  std::array<AxisChoice, 3> choices{};
  for (const coupling::ConstraintPlane& plane : planes) {
    const std::optional<AxisPlane> axis_plane = along_axis(plane);
    if (!axis_plane) {
      ++reply.unencodable;
      continue;
    }
    const Decoded<float> hand_mm = millimetres(hand[axis_plane->axis]);
    if (hand_mm) choices[axis_plane->axis].offer(*axis_plane, *hand_mm);
  }
  unsigned directions = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const AxisChoice& choice = choices[axis];
    put_float(std::span(reply.bytes).subspan(4 * axis).first<4>(), choice.plane_mm);
    if (choice.is_set) directions |= choice.is_upper ? less_bit(axis) : greater_bit(axis);
  }
  reply.bytes.back() = static_cast<std::byte>(directions);
  return reply;
}

Decoded<coupling::PlaneList> decode_thesis_reply(std::span<const std::byte> bytes) noexcept {
  if (bytes.size() != kThesisReplySize) return tl::unexpected(RejectReason::WrongSize);
  const auto directions = std::to_integer<unsigned>(bytes.back());
  if ((directions & ~kKnownBits) != 0) return tl::unexpected(RejectReason::BadDirection);
  coupling::PlaneList planes;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool is_less = (directions & less_bit(axis)) != 0;
    const bool is_greater = (directions & greater_bit(axis)) != 0;
    if (is_less && is_greater) return tl::unexpected(RejectReason::BadDirection);
    if (!is_less && !is_greater) continue;
    const Decoded<double> position_m = metres(get_float(bytes.subspan(4 * axis).first<4>()));
    if (!position_m) return tl::unexpected(position_m.error());
    coupling::ConstraintPlane plane;
    plane.normal[axis] = is_less ? 1 : -1;
    plane.offset_m = is_less ? *position_m : -*position_m;
    planes.push_back(plane);
  }
  return planes;
}

}  // namespace thimble::link
