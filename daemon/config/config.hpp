#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hal/base/realtime_priority.hpp"

namespace thimble::config {

// What a configuration file says, checked: every value is in range, every name resolves.
// docs/configuration.md describes each key; the members have the keys' names. An empty
// optional means "not said": the part that uses the value has the default.
// Plain values; SI units as in the suffixes.

struct DaemonConfig {
  std::optional<std::string> socket;  // else default_socket_path() of paths.hpp
  std::uint32_t socket_mode{0660};    // permission bits of the socket; never open to others
  std::optional<std::string> group;   // that owns the socket
  std::optional<std::string> flight_directory;  // else default_flight_directory()
  std::vector<std::string> plugins{};           // absolute paths of shared objects
  bool operator==(const DaemonConfig&) const = default;
};

enum class Realtime : std::uint8_t { BestEffort, Required };

struct ServoConfig {
  std::optional<double> rate_hz;  // of every arm; else each has that of its driver
  Realtime realtime{Realtime::BestEffort};
  int priority{kServoPriority};  // SCHED_FIFO, 1 to kMaxServoPriority
  std::optional<int> cpu;        // pins the servo threads
  bool operator==(const ServoConfig&) const = default;
};

// Level of an input whose contact is closed: the emergency stop released, the deadman held.
enum class ClosedLevel : std::uint8_t { Low, High };
// What holds an input whose contact is open at the other level.
enum class PullResistor : std::uint8_t { Internal, External };

// Of a simulated GPIO chip, as a CP2112 has. They have no names.
inline constexpr std::size_t kSimulatedLines = 8;

// Lines of one GPIO chip, by number or name.
struct SafetyConfig {
  std::string chip;                // its label; "sim:NAME": a simulated one
  std::vector<std::string> estop;  // one or two channels
  std::optional<std::string> deadman;
  std::optional<std::string> enable;
  std::optional<std::string> lamp;
  ClosedLevel closed_level{ClosedLevel::Low};
  PullResistor pull{PullResistor::Internal};
  [[nodiscard]] bool is_simulated() const noexcept { return chip.starts_with("sim:"); }
  bool operator==(const SafetyConfig&) const = default;
};

// A numeric address: nothing is resolved by name. IPv6 without its brackets.
struct UdpEndpoint {
  std::string address;
  std::uint16_t port{0};
  bool operator==(const UdpEndpoint&) const = default;
};

// A serial port of this machine and its rate.
struct SerialEndpoint {
  std::string node;  // "/dev/ttyS0"
  std::uint32_t bit_per_s{0};
  bool operator==(const SerialEndpoint&) const = default;
};

// Injected on a link. Delay and jitter are of the round trip; ratios, from 0 to 1, of one
// message in one direction.
struct ImpairmentConfig {
  double delay_s{0};
  double jitter_s{0};
  double loss{0};
  double duplicate{0};
  double reorder{0};
  std::uint64_t seed{1};
  bool operator==(const ImpairmentConfig&) const = default;
};

enum class HandMotion : std::uint8_t { Still, Poke, Sweep, Circle, Tremor, Explore };

// The simulated person who holds a simulated arm.
struct HandConfig {
  HandMotion motion{HandMotion::Still};
  std::uint64_t seed{1};
  std::optional<double> speed_m_per_s;
  std::optional<double> reach_m;
  std::optional<double> stiffness_newton_per_m;
  std::optional<double> damping_newton_s_per_m;
  std::optional<double> mass_kg;
  bool operator==(const HandConfig&) const = default;
};

// May only tighten DESIGN section 4.
struct LimitsConfig {
  std::optional<double> force_newton;  // else the arm's own peak
  double rise_newton_per_s{1000};
  double ramp_s{0.5};
  double overspeed_m_per_s{1.5};
  bool operator==(const LimitsConfig&) const = default;
};

enum class CouplingScheme : std::uint8_t {
  Auto,  // Composite where the world goes with it, else GhostPoint
  GhostPoint,
  ThesisLiteral,
  RemoteForce,
  SpringDamper,
  Wave,
  ConstraintPlane,
  BufferZone,
  Composite
};
enum class CouplingMode : std::uint8_t { Streamed, LockStep };
// Where the force of a spring-damper is computed.
enum class CouplingForceAt : std::uint8_t { World, Both };
// What becomes of a wall that a hand is already inside when it is told of.
enum class CouplingLateWalls : std::uint8_t { Offset, Recovery };
// What a buffer zone names.
enum class CouplingZone : std::uint8_t { Cells, Faces };

// A guard around the scheme; nothing where it is off.
struct PassivityConfig {
  std::optional<double> bound_joule{};
  std::optional<double> damping_newton_s_per_m{};
  std::optional<double> least_m_per_s{};
  bool is_two_port{false};  // between both ends, else at the hand's port alone
  bool operator==(const PassivityConfig&) const = default;
};

struct CouplingConfig {
  CouplingScheme scheme{CouplingScheme::Auto};
  CouplingMode mode{CouplingMode::Streamed};
  std::optional<double> stiffness_newton_per_m;
  std::optional<double> damping_newton_s_per_m;
  std::optional<double> coordinate_spring_newton_per_m;
  std::optional<double> hysteresis_m;
  std::optional<double> relaxation_m_per_s;
  std::optional<double> freeze_after_s;
  std::optional<double> fade_after_s;
  std::optional<double> impedance_newton_s_per_m{};
  std::optional<double> master_mass_kg{};  // of the spring-damper, else none
  CouplingForceAt force_at{CouplingForceAt::World};
  CouplingLateWalls late_walls{CouplingLateWalls::Offset};
  std::optional<double> recovery_s{};  // only with LateWalls Recovery
  std::optional<double> buffer_m{};
  CouplingZone zone{CouplingZone::Cells};
  std::optional<PassivityConfig> passivity{};
  bool operator==(const CouplingConfig&) const = default;
};

// Datagrams of 1999, or our own.
enum class LinkProtocol : std::uint8_t { Thesis, Thimble };

// What is done when an arm's device is not there at the start.
enum class Fallback : std::uint8_t { None, Simulated };

struct ArmConfig {
  std::string name;
  std::string device;  // bus address: "sim:MODEL", "hid:SERIAL" …
  std::optional<std::string> model;
  std::optional<double> amplifier_max_a;
  std::optional<std::string> firmware;  // file; a relative path is from the configuration's folder
  std::optional<std::string> firmware_sha256;
  std::optional<double> newton_per_count;
  Fallback fallback{Fallback::None};  // only for a real device, and beside model
  // Exactly one of the two, or peer, or listen.
  std::optional<std::string> world;  // name of a WorldConfig of the same file
  std::optional<UdpEndpoint> link;
  LinkProtocol protocol{LinkProtocol::Thesis};  // only with link
  bool allow_unauthenticated{false};            // only with link or listen
  bool activate{true};                          // the configuration's own lease
  std::optional<HandConfig> hand;  // present for "sim:" devices; else only beside a fallback
  LimitsConfig limits;
  CouplingConfig coupling;
  std::optional<ImpairmentConfig> impairment;
  // Instead of world and link: the name of the other ArmConfig of the same file.
  std::optional<std::string> peer{};
  std::array<double, 3> place_m{};        // of its base frame's origin in the world
  std::optional<std::string> key_file{};  // path; only with link and our own datagrams, or listen
  double deadband_m{0};                   // only with such a link; 0: every sample is sent
  std::optional<SerialEndpoint> line{};   // of the key link, where it is a serial line
  [[nodiscard]] bool is_remote() const noexcept { return link || line; }
  // Where the arm of another host comes that is its far end; port 0: any free one.
  std::optional<UdpEndpoint> listen{};
  std::optional<SerialEndpoint> listen_line{};  // of the key listen, where it is a serial line
  std::optional<std::string> peer_address{};    // of the key peer, beside listen
  [[nodiscard]] bool is_listening() const noexcept { return listen || listen_line; }
  bool operator==(const ArmConfig&) const = default;
};

// How a world decides what holds a hand: thesis 3.7.1, figures 3-9 and 3-8.
enum class ConstraintModel : std::uint8_t { GhostPoint, Simple };

// How cells of a volume file feel whose numbers are from `from` to `to`, ends included.
struct MaterialConfig {
  std::string name;
  double from{0};
  double to{0};
  std::optional<double> stiffness_newton_per_m;  // else the arm's
  std::optional<double> damping_newton_s_per_m;  // else the arm's
  std::optional<double> friction{};              // Coulomb's coefficient, else none
  std::optional<double> temperature_kelvin{};    // told, and felt by no arm of ours
  bool operator==(const MaterialConfig&) const = default;
};

// The ball and floor of thesis 3.2, y up. As it stands: the ball rests on the bottom of the
// thesis's workspace, and an arm that starts at the origin is 5 mm above its top.
struct SphereConfig {
  double radius_m{0.02};
  std::array<double, 3> center_m{0, -0.025, 0};
  double floor_m{-0.045};
  std::optional<double> stiffness_newton_per_m{};  // else the arm's
  std::optional<double> damping_newton_s_per_m{};  // else the arm's
  std::optional<double> friction{};                // Coulomb's coefficient, else none
  std::optional<double> temperature_kelvin{};      // told, and felt by no arm of ours
  bool operator==(const SphereConfig&) const = default;
};

// Of a volume file whose numbers are signed distances, below 0 in matter, and of a mesh, which
// becomes such (thesis 3.7.2).
struct FieldConfig {
  std::optional<double> unit_m{};                  // of one of its numbers, else 1 or longest_m
  std::optional<double> longest_m{};               // edge of a mesh, where unit_m is not said
  bool is_mesh{false};                             // by the ending of the source
  std::int64_t resolution{64};                     // of a mesh: steps along that edge
  std::array<double, 3> center_m{};                // of its middle
  std::optional<double> stiffness_newton_per_m{};  // else the arm's
  std::optional<double> damping_newton_s_per_m{};  // else the arm's
  std::optional<double> friction{};                // Coulomb's coefficient, else none
  std::optional<double> temperature_kelvin{};      // told, and felt by no arm of ours
  bool operator==(const FieldConfig&) const = default;
};

enum class ShapeKind : std::uint8_t { Sphere, Box, Capsule, Cylinder, Floor };

// A piece of matter of the source "shapes" (thesis 3.7.2). Sizes that its kind has not are 0.
struct ShapeConfig {
  ShapeKind kind{ShapeKind::Sphere};
  std::array<double, 3> center_m{};
  std::array<double, 3> rotation_rad{};  // a rotation vector
  double radius_m{0};
  double length_m{0};  // along y: of a cylinder; of a capsule between the centers of its ends
  std::array<double, 3> size_m{};                  // edges of a box
  std::optional<double> stiffness_newton_per_m{};  // else the arm's
  std::optional<double> damping_newton_s_per_m{};  // else the arm's
  std::optional<double> friction{};                // Coulomb's coefficient, else none
  std::optional<double> temperature_kelvin{};      // told, and felt by no arm of ours
  bool operator==(const ShapeConfig&) const = default;
};

// A block that hands push about a room (thesis 5.2, 5.3.4).
struct BlockConfig {
  double room_m{0.09};
  double edge_m{0.03};
  double drag_newton_s_per_m{40};
  double friction{0};                     // Coulomb's coefficient
  std::array<double, 3> weight_newton{};  // what pulls it, along the world's axes
  bool operator==(const BlockConfig&) const = default;
};

enum class PieceSearch : std::uint8_t { Leap, OneCell, Trail };

// A simulated board, in a slot of PCI or on USB; or a real one, likewise.
enum class PieceBoardKind : std::uint8_t { Sim, SimUsb, Usb, Pci };

// The thesis's static pieces on a CAM board (4.2.1, 4.2.2).
struct PiecesConfig {
  int cells{512};  // along each axis; a power of two
  int count{20};   // of pieces
  std::uint64_t seed{1};
  PieceSearch search{PieceSearch::Leap};
  int boards{8};  // modules of a simulated machine; a power of two
  PieceBoardKind board{PieceBoardKind::Sim};
  int axes{2};  // x and y, or all three
  std::optional<std::string>
      layout{};            // path of a volume file, instead of cells, axes, count, seed
  bool is_dynamic{false};  // the held piece gives off particles; up to 7 pieces
  std::optional<double> pressure_newton_per_m{};  // of a face, for each cell that presses on it
  std::optional<int> display_every{};  // moves after which the board shows itself on its monitor
  bool operator==(const PiecesConfig&) const = default;
};

// A cellular automaton that runs while it is touched (thesis 5.4.1).
struct AutomatonConfig {
  int axes{2};     // x and y, or all three
  int cells{256};  // along each of them; a power of two
  std::uint64_t seed{1};
  std::optional<double> fill_fraction{};  // of what lives or diffuses at first; else the rule's
  double steps_per_s{10};
  double poke_cells{3};  // radius of what a button changes
  bool operator==(const AutomatonConfig&) const = default;
};

struct WorldConfig {
  std::string name;
  std::string source;  // "box:N", "sphere", "block", "shapes", "pieces", "life", "crystal", or the
                       // path of a file
  double workspace_m{0.09};
  double threshold{0};  // cells above it are filled (files)
  ConstraintModel constraint_model{ConstraintModel::GhostPoint};
  std::optional<UdpEndpoint> listen;  // port 0: any free one
  bool allow_unauthenticated{false};
  std::optional<std::string> peer;  // the only address that is answered
  std::optional<ImpairmentConfig> impairment;
  // Of volume files.
  std::optional<double> cell_m{};  // instead of workspace_m
  std::string axis_order{"xyz"};   // axis of the world of each axis of the file; - before: reversed
  std::optional<std::array<double, 3>> spacing{};  // along them, instead of the file's
  std::vector<MaterialConfig> materials{};         // the first that fits counts
  std::optional<FieldConfig> field{};              // its numbers are distances, or it is a mesh
  std::optional<SphereConfig> sphere{};            // of the source "sphere", and only there
  std::vector<ShapeConfig> shapes{};               // of "shapes", which has at least one
  std::optional<BlockConfig> block{};              // likewise of "block"
  std::optional<PiecesConfig> pieces{};            // likewise of "pieces"
  std::optional<AutomatonConfig> automaton{};      // of "life" and "crystal"
  std::optional<std::string> key_file{};           // path; only with listen
  std::optional<SerialEndpoint> line{};            // of the key listen, where it is a serial line
  [[nodiscard]] bool is_listening() const noexcept { return listen || line; }
  bool operator==(const WorldConfig&) const = default;
};

struct Config {
  DaemonConfig daemon;
  ServoConfig servo;
  std::vector<ArmConfig> arms;
  std::vector<WorldConfig> worlds;
  std::optional<SafetyConfig> safety{};
  bool operator==(const Config&) const = default;
};

}  // namespace thimble::config
