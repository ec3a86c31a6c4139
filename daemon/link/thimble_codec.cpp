#include "daemon/link/thimble_codec.hpp"

#include "daemon/link/thimble_codec_parts.hpp"

namespace thimble::link {
using namespace codec;
namespace {

// Rounding of a normal that somebody made of length 1 in binary32.
constexpr double kUnitTolerance = 1e-6;

// Bits of the masks, in the order in which the fields stand.
constexpr std::uint32_t kVelocity = 1U << 0U;
constexpr std::uint32_t kTool = 1U << 1U;
constexpr std::uint32_t kWaves = 1U << 2U;
constexpr std::uint32_t kImpulse = 1U << 3U;
constexpr std::uint32_t kPresses = 1U << 4U;
constexpr std::uint32_t kSampleEnergy = 1U << 5U;
constexpr std::uint32_t kSampleEpoch = 1U << 6U;
constexpr std::uint32_t kNeverASampleField = 1U << 7U;
constexpr std::uint32_t kArmsGhost = 1U << 8U;
constexpr std::uint32_t kAppliedBefore = 1U << 9U;
constexpr std::uint32_t kPull = 1U << 10U;
constexpr std::uint32_t kActions = 1U << 11U;
constexpr std::uint32_t kSampleFields = (1U << 12U) - 1;

constexpr std::uint32_t kPlanes = 1U << 0U;
constexpr std::uint32_t kGhost = 1U << 1U;
constexpr std::uint32_t kGhostCell = 1U << 2U;
constexpr std::uint32_t kEmbedded = 1U << 3U;
constexpr std::uint32_t kFar = 1U << 4U;
constexpr std::uint32_t kEpoch = 1U << 5U;
constexpr std::uint32_t kPressure = 1U << 6U;
constexpr std::uint32_t kEnergy = 1U << 7U;
constexpr std::uint32_t kNear = 1U << 8U;
constexpr std::uint32_t kAstray = 1U << 9U;
constexpr std::uint32_t kMap = 1U << 10U;
constexpr std::uint32_t kFarArm = 1U << 11U;
constexpr std::uint32_t kConstraintFields = (1U << 12U) - 1;

// Of a surface.
constexpr std::uint8_t kStiffness = 1U << 0U;
constexpr std::uint8_t kDamping = 1U << 1U;
constexpr std::uint8_t kFriction = 1U << 2U;
constexpr std::uint8_t kTemperature = 1U << 3U;
constexpr std::uint8_t kSurfaceFields = (1U << 4U) - 1;

std::uint32_t flag(bool is_said, std::uint32_t bit) noexcept { return is_said ? bit : 0; }
std::uint8_t flag(bool is_said, std::uint8_t bit) noexcept {
  return is_said ? bit : std::uint8_t{0};
}

std::uint32_t mask_of(const ThimbleSample& m) noexcept {
  const coupling::HandSample& s = m.sample;
  return flag(s.velocity != Velocity3(), kVelocity) |
         flag(s.tool != coupling::ToolProperties(), kTool) |
         flag(s.waves != coupling::WaveSums(), kWaves) |
         flag(s.impulse != coupling::Impulse3(), kImpulse) | flag(s.has_presses, kPresses) |
         flag(!(s.energy_joule < 0), kSampleEnergy) | flag(s.epoch != 0, kSampleEpoch) |
         flag(m.sample.has_ghost, kArmsGhost) | flag(m.sample.applied_before != 0, kAppliedBefore) |
         flag(s.pull != Force3(), kPull) | flag(s.has_actions, kActions);
}

// Zones and maps tell the cell themselves.
bool is_cell_alone(const coupling::ConstraintSet& set) noexcept {
  return set.has_ghost_cell && !set.has_near && !set.has_map;
}

std::uint32_t mask_of(const ThimbleConstraints& m) noexcept {
  return flag(!m.set.planes.empty(), kPlanes) | flag(m.set.has_ghost, kGhost) |
         flag(is_cell_alone(m.set), kGhostCell) | flag(m.set.is_embedded, kEmbedded) |
         flag(m.set.has_far, kFar) | flag(m.set.has_map && m.set.map.epoch != 0, kEpoch) |
         flag(m.set.has_pressure, kPressure) | flag(!(m.set.energy_joule < 0), kEnergy) |
         flag(m.set.has_near, kNear) | flag(m.set.is_astray, kAstray) | flag(m.set.has_map, kMap) |
         flag(m.set.has_far && m.set.far.is_arm, kFarArm);
}

// Said by the writer; to be read by the reader.
template <class Bytes, class Message>
std::uint32_t first_mask(const Message& m) noexcept {
  if constexpr (Bytes::kIsReader) return 0;
  return mask_of(m);
}

template <class Bytes, class Message>
bool carry_sample(Bytes& b, Message& m) noexcept {
  carry_timing(b, m.timing);
  auto& s = m.sample;
  std::uint32_t mask = first_mask<Bytes>(m);
  b.values(s.sequence, s.sampled_at, s.restart, s.buttons, s.applied_reply, s.hand, mask);
  carry_said(b, (mask & kVelocity) != 0, s.velocity);
  carry_said(b, (mask & kTool) != 0, s.tool.stiffness.newton_per_m, s.tool.damping.newton_s_per_m);
  carry_said(b, (mask & kWaves) != 0, s.waves.distance, s.waves.joule);
  carry_said(b, (mask & kImpulse) != 0, s.impulse);
  carry_said(b, (mask & kPresses) != 0, s.presses);
  carry_known(b, (mask & kSampleEnergy) != 0, s.energy_joule);
  carry_said(b, (mask & kSampleEpoch) != 0, s.epoch);
  carry_said(b, (mask & kArmsGhost) != 0, s.ghost);
  carry_said(b, (mask & kAppliedBefore) != 0, s.applied_before);
  carry_said(b, (mask & kPull) != 0, s.pull);
  carry_said(b, (mask & kActions) != 0, s.actions);
  if constexpr (Bytes::kIsReader) {
    s.has_presses = (mask & kPresses) != 0;
    s.has_actions = (mask & kActions) != 0;
    s.has_ghost = (mask & kArmsGhost) != 0;
    if ((mask & kNeverASampleField) != 0) b.refuse();
  }
  return mask > kSampleFields;
}

template <class Bytes, class Plane>
void carry_plane(Bytes& b, Plane& plane) noexcept {
  auto& surface = plane.surface;
  std::uint8_t mask = 0;
  if constexpr (!Bytes::kIsReader) {
    // Not "is positive": what is no number is said, and refused.
    mask = static_cast<std::uint8_t>(flag(!(surface.stiffness.newton_per_m < 0), kStiffness) |
                                     flag(!(surface.damping.newton_s_per_m < 0), kDamping) |
                                     flag(!(surface.friction < 0), kFriction) |
                                     flag(!(surface.temperature_kelvin < 0), kTemperature));
  }
  b.values(plane.normal, plane.offset_m, mask);
  if constexpr (Bytes::kIsReader) {
    if (mask > kSurfaceFields) return b.refuse();
  }
  carry_known(b, (mask & kStiffness) != 0, surface.stiffness.newton_per_m);
  carry_known(b, (mask & kDamping) != 0, surface.damping.newton_s_per_m);
  carry_known(b, (mask & kFriction) != 0, surface.friction);
  carry_known(b, (mask & kTemperature) != 0, surface.temperature_kelvin);
  if constexpr (Bytes::kIsReader) {
    const bool is_said_to_be_unsaid =
        ((mask & kStiffness) != 0 && surface.stiffness.newton_per_m < 0) ||
        ((mask & kDamping) != 0 && surface.damping.newton_s_per_m < 0) ||
        ((mask & kFriction) != 0 && surface.friction < 0) ||
        ((mask & kTemperature) != 0 && surface.temperature_kelvin < 0);
    if (is_said_to_be_unsaid) b.refuse();
  }
}

template <class Bytes, class Planes>
void carry_planes(Bytes& b, Planes& planes) noexcept {
  carry_count(b, planes);
  if constexpr (Bytes::kIsReader) {
    if (planes.empty()) return b.refuse();
  }
  for (auto& plane : planes) carry_plane(b, plane);
}

template <class Bytes, class Far>
void carry_far(Bytes& b, Far& far) noexcept {
  b.values(far.force, far.slave, far.velocity);
  b.values(far.waves.distance, far.waves.joule);
  carry_flag(b, far.is_pressing);
  if constexpr (Bytes::kIsReader) far.is_arm = false, far.tool = {};
}

// What a far end is beside a place and a motion, where it is an arm.
template <class Bytes, class Set>
void carry_far_arm(Bytes& b, Set& set) noexcept {
  if constexpr (Bytes::kIsReader) {
    if (!set.has_far) return b.refuse();
    set.far.is_arm = true;
  }
  b.values(set.far.tool.stiffness.newton_per_m, set.far.tool.damping.newton_s_per_m);
}

template <class Bytes, class Message>
bool carry_constraints(Bytes& b, Message& m) noexcept {
  carry_timing(b, m.timing);
  auto& set = m.set;
  std::uint32_t mask = first_mask<Bytes>(m);
  b.values(m.request, set.sequence, set.answers, set.sampled_at, set.session, mask);
  if constexpr (Bytes::kIsReader) {
    set.has_ghost = (mask & kGhost) != 0;
    set.is_embedded = (mask & kEmbedded) != 0;
    set.has_far = (mask & kFar) != 0;
    set.has_near = (mask & kNear) != 0;
    set.is_astray = (mask & kAstray) != 0;
    set.has_map = (mask & kMap) != 0;
    set.has_pressure = (mask & kPressure) != 0;
    set.planes.clear();
  }
  if ((mask & kPlanes) != 0) carry_planes(b, set.planes);
  carry_said(b, set.has_ghost, set.ghost);
  carry_said(b, (mask & kGhostCell) != 0, set.ghost_cell);
  if (set.has_far) carry_far(b, set.far);
  carry_said(b, (mask & kEpoch) != 0, set.map.epoch);
  carry_said(b, set.has_pressure, set.pressure);
  carry_known(b, (mask & kEnergy) != 0, set.energy_joule);
  if (set.has_near) carry_near(b, set.near);
  if (set.has_map) carry_map(b, set.map);
  if ((mask & kFarArm) != 0) carry_far_arm(b, set);
  if constexpr (Bytes::kIsReader) {
    set.has_ghost_cell = (mask & (kGhostCell | kNear | kMap)) != 0;
    if (set.has_near) set.ghost_cell = set.near.middle;
    if (set.has_map) set.ghost_cell = set.map.ghost_cell;
  }
  return mask > kConstraintFields;
}

template <class Bytes, class Message>
bool carry_idle(Bytes& b, Message& m) noexcept {
  carry_timing(b, m.timing);
  b.values(m.request);
  return false;
}

Reason check_plane(const coupling::ConstraintPlane& plane) noexcept {
  const coupling::SurfaceProperties& surface = plane.surface;
  const Reason reason = first_of(
      check_finite(plane.normal), check_reach(plane.offset_m),
      check_finite(surface.stiffness.newton_per_m), check_finite(surface.damping.newton_s_per_m),
      check_finite(surface.friction), check_finite(surface.temperature_kelvin));
  if (reason) return reason;
  return unless(std::abs(norm(plane.normal) - 1) <= kUnitTolerance, RejectReason::BadDirection);
}

}  // namespace

// Found by encode_as() and decode_as() through the messages' namespace.
static bool carry(ByteWriter& b, const ThimbleSample& m) noexcept { return carry_sample(b, m); }
static bool carry(ByteReader& b, ThimbleSample& m) noexcept { return carry_sample(b, m); }
static bool carry(ByteWriter& b, const ThimbleConstraints& m) noexcept {
  return carry_constraints(b, m);
}
static bool carry(ByteReader& b, ThimbleConstraints& m) noexcept { return carry_constraints(b, m); }
static bool carry(ByteWriter& b, const ThimbleIdle& m) noexcept { return carry_idle(b, m); }
static bool carry(ByteReader& b, ThimbleIdle& m) noexcept { return carry_idle(b, m); }
static Reason check(const ThimbleSample& m) noexcept {
  const coupling::HandSample& s = m.sample;
  return first_of(check_timing(m.timing), check_time(s.sampled_at), check_place(s.hand),
                  check_finite(s.velocity), check_tool(s.tool), check_waves(s.waves),
                  check_finite(s.impulse), check_finite(s.energy_joule),
                  s.has_ghost ? check_place(s.ghost) : Reason(), check_finite(s.pull));
}

static Reason check(const ThimbleConstraints& m) noexcept {
  const coupling::ConstraintSet& set = m.set;
  for (std::size_t i = 0; i < set.planes.size(); ++i) {
    if (const Reason reason = check_plane(set.planes[i])) return reason;
  }
  const Reason reason = first_of(
      check_timing(m.timing), check_time(set.sampled_at),
      set.has_ghost ? check_place(set.ghost) : Reason(),
      set.has_pressure ? check_finite(set.pressure) : Reason(), check_finite(set.energy_joule),
      is_cell_alone(set) ? check_lattice({}, set.ghost_cell) : Reason(),
      set.has_near ? check_lattice(set.near.lattice, set.near.middle) : Reason(),
      set.has_map ? check_lattice(set.map.lattice, set.map.ghost_cell) : Reason());
  if (reason || !set.has_far) return reason;
  const coupling::FarEnd& far = set.far;
  return first_of(check_finite(far.force), check_place(far.slave), check_finite(far.velocity),
                  check_waves(far.waves), check_tool(far.tool));
}

static Reason check(const ThimbleIdle& m) noexcept { return check_timing(m.timing); }

Decoded<std::size_t> encode(const ThimbleSample& message,
                            std::span<std::byte, kMaxThimbleContent> out) noexcept {
  ThimbleSample bounded = message;
  for (Position3* const place : {&bounded.sample.hand, &bounded.sample.ghost}) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double& along_m = (*place)[axis];
      along_m = std::clamp(along_m, -kMaxThesisCoordinate_m, kMaxThesisCoordinate_m);
    }
  }
  return encode_as(bounded, out);
}
Decoded<std::size_t> encode(const ThimbleConstraints& message,
                            std::span<std::byte, kMaxThimbleContent> out) noexcept {
  return encode_as(message, out);
}
Decoded<std::size_t> encode(const ThimbleIdle& message,
                            std::span<std::byte, kMaxThimbleContent> out) noexcept {
  return encode_as(message, out);
}

Decoded<void> decode(std::span<const std::byte> content, ThimbleSample& out) noexcept {
  return decode_as(content, out);
}
Decoded<void> decode(std::span<const std::byte> content, ThimbleConstraints& out) noexcept {
  return decode_as(content, out);
}
Decoded<void> decode(std::span<const std::byte> content, ThimbleIdle& out) noexcept {
  return decode_as(content, out);
}

}  // namespace thimble::link
