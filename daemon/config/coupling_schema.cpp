#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "daemon/config/peers.hpp"
#include "daemon/config/schema.hpp"

namespace thimble::config {
namespace {

using Scheme = CouplingScheme;

constexpr std::array<Choice<Scheme>, 9> kSchemes{{
    {"auto", Scheme::Auto},
    {"ghost-point", Scheme::GhostPoint},
    {"thesis-literal", Scheme::ThesisLiteral},
    {"remote-force", Scheme::RemoteForce},
    {"spring-damper", Scheme::SpringDamper},
    {"wave", Scheme::Wave},
    {"constraint-plane", Scheme::ConstraintPlane},
    {"buffer-zone", Scheme::BufferZone},
    {"composite", Scheme::Composite},
}};
constexpr std::array<Choice<CouplingMode>, 2> kModes{{
    {"streamed", CouplingMode::Streamed},
    {"lock-step", CouplingMode::LockStep},
}};
constexpr std::array<Choice<CouplingForceAt>, 2> kForceAt{{
    {"world", CouplingForceAt::World},
    {"both", CouplingForceAt::Both},
}};
constexpr std::array<Choice<CouplingLateWalls>, 2> kLateWalls{{
    {"offset", CouplingLateWalls::Offset},
    {"recovery", CouplingLateWalls::Recovery},
}};

constexpr std::array<Choice<CouplingZone>, 2> kZones{{
    {"cells", CouplingZone::Cells},
    {"faces", CouplingZone::Faces},
}};

// Beyond these a number is a slip of the pen, not a wish; what a far end computes with has the
// ceilings of its world half (coupling/wall_penalty.hpp, slave.hpp, wave_channel.hpp).
constexpr Range kAge{0, 60, true};
constexpr Range kImpedance{0.1, 40};
constexpr Range kBuffer{0, 1, true};
constexpr Range kMasterMass{0.02, 2};  // SpringDamperSettings::kLightestMaster_kg

Range stiffness_range(Scheme scheme) {
  const bool is_far = scheme == Scheme::RemoteForce || scheme == Scheme::SpringDamper;
  return is_far ? Range{0, 3000, true} : Range{0, 20000, true};
}

Range damping_range(Scheme scheme) {
  if (scheme == Scheme::RemoteForce) return {0, 20};
  if (scheme == Scheme::SpringDamper) return {0, 200, true};
  return {0, 1000};
}

// Which schemes take a key that not all take.
struct Tuning {
  const char* key;
  std::vector<Scheme> schemes;
};

const std::vector<Tuning>& tunings() {
  static const std::vector<Tuning> kTunings{
      {"stiffness_newton_per_m",
       {Scheme::Auto, Scheme::GhostPoint, Scheme::Composite, Scheme::ConstraintPlane,
        Scheme::RemoteForce, Scheme::SpringDamper, Scheme::BufferZone}},
      {"damping_newton_s_per_m",
       {Scheme::Auto, Scheme::GhostPoint, Scheme::Composite, Scheme::ConstraintPlane,
        Scheme::RemoteForce, Scheme::SpringDamper, Scheme::BufferZone}},
      {"coordinate_spring_newton_per_m", {Scheme::Auto, Scheme::GhostPoint, Scheme::Composite}},
      {"hysteresis_m",
       {Scheme::Auto, Scheme::GhostPoint, Scheme::Composite, Scheme::ConstraintPlane}},
      {"relaxation_m_per_s",
       {Scheme::Auto, Scheme::GhostPoint, Scheme::Composite, Scheme::ConstraintPlane}},
      {"late_walls", {Scheme::ConstraintPlane}},
      {"recovery_s", {Scheme::ConstraintPlane}},
      {"impedance_newton_s_per_m", {Scheme::Wave}},
      {"force_at", {Scheme::SpringDamper}},
      {"master_mass_kg", {Scheme::SpringDamper}},
      {"buffer_m", {Scheme::BufferZone}},
      {"zone", {Scheme::BufferZone}},
  };
  return kTunings;
}

std::string listed(const std::vector<Scheme>& schemes) {
  std::string out;
  for (std::size_t i = 0; i < schemes.size(); ++i) {
    if (i > 0) out += i + 1 == schemes.size() ? " or " : ", ";
    out += in_quotes(to_string(schemes[i]));
  }
  return out;
}

// A number that would be ignored is a mistake.
void refuse_what_is_not_taken(TableReader& reader, Scheme scheme) {
  for (const auto& [key, schemes] : tunings()) {
    if (std::find(schemes.begin(), schemes.end(), scheme) != schemes.end()) continue;
    if (!reader.has(key)) continue;
    const bool is_printed = scheme == Scheme::ThesisLiteral && schemes.front() == Scheme::Auto;
    if (is_printed) {
      reader.reject(key, "expected only with scheme " + listed(schemes) +
                             ", since \"thesis-literal\" has its numbers printed; found beside it");
      continue;
    }
    reader.reject(key, "expected only with scheme " + listed(schemes) + ", found beside " +
                           in_quotes(to_string(scheme)));
  }
}

// Walls that slide to their place shift no frame.
void refuse_beside_late_walls(TableReader& reader, const CouplingConfig& said) {
  if (said.scheme != Scheme::ConstraintPlane) return;
  const bool recovers = said.late_walls == CouplingLateWalls::Recovery;
  if (recovers && reader.has("relaxation_m_per_s")) {
    reader.reject("relaxation_m_per_s",
                  "expected only with late_walls = \"offset\", found beside \"recovery\"");
  }
  if (!recovers && reader.has("recovery_s")) {
    reader.reject("recovery_s",
                  "expected only with late_walls = \"recovery\", found beside \"offset\"");
  }
}

enum class TwoPort : std::uint8_t { Yes };
constexpr std::array<Choice<TwoPort>, 1> kTwoPort{{{"two-port", TwoPort::Yes}}};

// A guard that can be put on any scheme.
std::optional<PassivityConfig> read_passivity(TableReader& reader) {
  bool is_on = false;
  PassivityConfig out;
  if (reader.has_text("passivity")) {
    TwoPort word{};
    is_on = out.is_two_port =
        reader.read("passivity", std::span<const Choice<TwoPort>>(kTwoPort), word);
  } else {
    reader.read("passivity", is_on);
  }
  reader.read("passivity_bound_joule", {0, 1}, out.bound_joule);
  reader.read("passivity_damping_newton_s_per_m", {0, 1000, true}, out.damping_newton_s_per_m);
  reader.read("passivity_least_m_per_s", {0, 1}, out.least_m_per_s);
  if (is_on) return out;
  for (const char* key :
       {"passivity_bound_joule", "passivity_damping_newton_s_per_m", "passivity_least_m_per_s"}) {
    if (reader.has(key)) reader.reject(key, "expected only beside passivity = true");
  }
  return std::nullopt;
}

// Where both ends have a port that energy goes through, and neither minds the other's already.
void refuse_two_ports(TableReader& reader, const CouplingConfig& said) {
  if (!said.passivity || !said.passivity->is_two_port) return;
  if (reader.has("passivity_damping_newton_s_per_m")) {
    reader.reject("passivity_damping_newton_s_per_m",
                  "expected only beside passivity = true: \"two-port\" withholds and has no cap");
  }
  const bool tells_force =
      said.scheme == Scheme::RemoteForce ||
      (said.scheme == Scheme::SpringDamper && said.force_at == CouplingForceAt::World);
  if (tells_force) return;
  if (said.scheme == Scheme::Wave) {
    reader.reject("passivity",
                  "expected true or false beside \"wave\", whose waves are guarded between both "
                  "ends already; found \"two-port\"");
    return;
  }
  reader.reject(
      "passivity",
      "expected true or false where no force is told by the world (\"two-port\" goes with "
      "\"remote-force\" and with \"spring-damper\", force_at = \"world\"); found "
      "\"two-port\" beside " +
          in_quotes(to_string(said.scheme)));
}

// What does; empty: a sample now and then will do.
std::string_view follows_a_stream(Scheme scheme) {
  if (scheme == Scheme::SpringDamper || scheme == Scheme::Wave) return "slave";
  if (scheme == Scheme::Composite) return "map";
  return scheme == Scheme::BufferZone ? "zone" : "";
}

}  // namespace

std::string_view to_string(CouplingScheme scheme) {
  for (const auto& [word, value] : kSchemes) {
    if (value == scheme) return word;
  }
  return "";
}

bool has_own_world_half(CouplingScheme scheme) {
  return scheme == Scheme::RemoteForce || scheme == Scheme::SpringDamper ||
         scheme == Scheme::Wave || scheme == Scheme::BufferZone || scheme == Scheme::Composite;
}

CouplingConfig read_coupling(TableReader reader) {
  CouplingConfig out;
  reader.read("scheme", std::span<const Choice<Scheme>>(kSchemes), out.scheme);
  reader.read("mode", std::span<const Choice<CouplingMode>>(kModes), out.mode);
  reader.read("force_at", std::span<const Choice<CouplingForceAt>>(kForceAt), out.force_at);
  reader.read("late_walls", std::span<const Choice<CouplingLateWalls>>(kLateWalls), out.late_walls);
  reader.read("recovery_s", {0.01, 10}, out.recovery_s);
  reader.read("stiffness_newton_per_m", stiffness_range(out.scheme), out.stiffness_newton_per_m);
  reader.read("damping_newton_s_per_m", damping_range(out.scheme), out.damping_newton_s_per_m);
  reader.read("impedance_newton_s_per_m", kImpedance, out.impedance_newton_s_per_m);
  reader.read("master_mass_kg", kMasterMass, out.master_mass_kg);
  reader.read("buffer_m", kBuffer, out.buffer_m);
  reader.read("zone", std::span<const Choice<CouplingZone>>(kZones), out.zone);
  reader.read("coordinate_spring_newton_per_m", {0, 1000}, out.coordinate_spring_newton_per_m);
  reader.read("hysteresis_m", {0, 0.01, true}, out.hysteresis_m);
  reader.read("relaxation_m_per_s", {0, 1}, out.relaxation_m_per_s);
  reader.read("freeze_after_s", kAge, out.freeze_after_s);
  reader.read("fade_after_s", kAge, out.fade_after_s);
  out.passivity = read_passivity(reader);
  refuse_what_is_not_taken(reader, out.scheme);
  refuse_beside_late_walls(reader, out);
  refuse_two_ports(reader, out);
  if (const std::string_view what = follows_a_stream(out.scheme);
      !what.empty() && out.mode == CouplingMode::LockStep) {
    reader.reject("mode", "expected \"streamed\" with scheme " + in_quotes(to_string(out.scheme)) +
                              ", whose " + std::string(what) +
                              " follows a stream; found \"lock-step\"");
  }
  reader.finish();
  return out;
}

bool are_peers(CouplingScheme one, CouplingScheme other) {
  const auto meant = [](Scheme said) { return said == Scheme::Auto ? Scheme::GhostPoint : said; };
  const Scheme mine = meant(one);
  const Scheme theirs = meant(other);
  if (mine == Scheme::Wave || theirs == Scheme::Wave) return mine == theirs;
  return (mine == Scheme::SpringDamper &&
          (theirs == Scheme::SpringDamper || theirs == Scheme::GhostPoint)) ||
         (mine == Scheme::GhostPoint && theirs == Scheme::SpringDamper);
}

void check_listening_arm(TableReader& reader, const ArmConfig& arm) {
  if (!arm.is_listening()) return;
  const Scheme scheme = arm.coupling.scheme;
  const bool is_streamed = arm.coupling.mode == CouplingMode::Streamed;
  const bool has_peers = are_peers(scheme, Scheme::SpringDamper) || scheme == Scheme::Wave;
  if (is_streamed && has_peers) return;
  // The arm's own table knows "coupling", not what is below it.
  reader.reject("coupling",
                "expected \"wave\", \"spring-damper\" or \"ghost-point\", streamed, of an arm that "
                "listens for another one; found " +
                    in_quotes(is_streamed ? to_string(scheme) : "lock-step"));
}

// Cells are told of where the world has them.
void check_place(TableReader& reader, const ArmConfig& arm) {
  const Scheme scheme = arm.coupling.scheme;
  const bool is_of_cells = scheme == Scheme::BufferZone || scheme == Scheme::Composite;
  if (!is_of_cells || arm.place_m == std::array<double, 3>{}) return;
  reader.reject("place_m", "expected none beside the scheme " + in_quotes(to_string(scheme)) +
                               ", which knows cells only where they are; use \"ghost-point\"");
}

void check_carriage(TableReader& reader, const ArmConfig& arm) {
  check_place(reader, arm);
  const bool is_between_arms = arm.peer || arm.is_listening();
  if (is_between_arms && arm.coupling.passivity && arm.coupling.passivity->is_two_port) {
    reader.reject("coupling",
                  "passivity = \"two-port\" needs a world that tells a force, not an arm; use "
                  "passivity = true");
  }
  const bool is_far = has_own_world_half(arm.coupling.scheme);
  const bool is_ours = arm.protocol == LinkProtocol::Thimble;
  const bool is_streamed = arm.coupling.mode == CouplingMode::Streamed;
  if (arm.is_remote() && arm.deadband_m > 0 && (is_far || !is_ours || !is_streamed)) {
    reader.reject("deadband_m",
                  "expected only with protocol = \"thimble\", streamed, and scheme "
                  "\"ghost-point\", \"constraint-plane\" or \"thesis-literal\"");
  }
  if (!arm.is_remote() || is_ours || !is_far) return;
  // The arm's own table knows "coupling", not what is below it.
  const std::string scheme = in_quotes(to_string(arm.coupling.scheme));
  if (arm.coupling.scheme == Scheme::BufferZone || arm.coupling.scheme == Scheme::Composite) {
    reader.reject("coupling",
                  scheme +
                      " needs to know what is near the ghost, which the datagrams of "
                      "1999 do not carry; use protocol = \"thimble\", or name a world of "
                      "this configuration instead of a link");
    return;
  }
  reader.reject("coupling", scheme +
                                " needs forces and motion of the far end, which the datagrams of "
                                "1999 do not carry; use protocol = \"thimble\", or name a world of "
                                "this configuration instead of a link");
}

}  // namespace thimble::config
