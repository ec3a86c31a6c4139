#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace thimble::api {

// What the daemon tells about itself; the members have the names of the JSON document
// (docs/api.md). Plain values, filled on the net thread from the servos' snapshots.
// Units: SI as in the suffixes; vectors in the base frame of the arm (= world frame).

struct FaultStatus {
  std::string code;         // "overspeed" …
  std::string message;      // what happened and what to do
  double at_s{0};           // daemon uptime
  std::string recording;    // path of the flight recording; empty when there is none
  std::uint32_t number{0};  // counts an arm's from 1; 0: not latched, it goes when the arm is back
  bool operator==(const FaultStatus&) const = default;
};

// A half-space that the hand may not enter: dot(normal, q) <= offset_m is left free. World frame.
struct PlaneStatus {
  std::array<double, 3> normal{};  // into the obstacle
  double offset_m{0};
  std::optional<double> temperature_kelvin{};  // of the surface, where it has one
  bool operator==(const PlaneStatus&) const = default;
};

// What an eye has to see for it to match what the hand feels. World frame.
struct FeltStatus {
  std::array<double, 3> position_m{};
  double lag_s{0};  // how long ago the hand was there
  std::optional<std::array<double, 3>> ghost_m{};
  std::vector<PlaneStatus> planes{};                        // that hold the hand now
  std::optional<std::array<std::int32_t, 3>> ghost_cell{};  // in worlds of cells
  // With which the cells of a face press back, as the world reckons; beside what the arm makes, not
  // on top of it.
  std::optional<std::array<double, 3>> pressure_newton{};
  bool operator==(const FeltStatus&) const = default;
};

struct ArmStatus {
  std::string name;
  std::string device;
  std::string stands_in_for;  // the device that is not there yet; empty: this one is the arm
  std::string model;
  std::string state;        // OperatingState in words
  std::string calibration;  // "unknown", "needs-user" or "ok"
  std::string instruction;  // what the person should do now; empty when nothing
  std::array<double, 3> position_m{};
  // Angles of the gimbal's axes; empty where the arm has none, or while they mean nothing.
  std::vector<double> gimbal_rad;
  std::array<double, 3> force_newton{};
  double peak_force_newton{0};  // largest norm since the start
  std::array<double, 3> offset_m{};
  FeltStatus felt{};
  double peak_offset_m{0};        // largest norm since the start
  double wished_energy_joule{0};  // given to the hand by the scheme, before the limiter
  std::uint64_t contacts{0};      // begun since the start
  std::vector<FaultStatus> faults;
  double newton_per_count{0};  // by which it is told its force; 0: it is told amperes
  double max_force_newton{0};  // the strongest that the limiter lets through; 0: it makes none
  bool is_in_contact{false};
  std::string lease;              // "configuration", "client" or "none": who keeps it active
  std::uint64_t lease_number{0};  // of a client's lease, another one for each; 0: no client has it
  std::string constraint_state;   // "fresh", "frozen", "fading" …
  std::string world;              // name of its world, or the peer that has it
  bool operator==(const ArmStatus&) const = default;
};

struct Percentiles {
  double p50{0};
  double p99{0};
  double max{0};
  bool operator==(const Percentiles&) const = default;
};

struct ServoStatus {
  std::string arm;
  std::optional<double> rate_hz;  // as ArmSession::rate_hz(); nothing is no member of the document
  std::uint64_t ticks{0};
  std::uint64_t overruns{0};
  Percentiles wakeup_error_s;
  Percentiles compute_s;
  Percentiles exchange_s;
  bool is_realtime{false};
  std::uint64_t missed_exchanges{0};  // device periods without a sample, or with no command taken
  // This one and the next are of every device that was the arm since the start: they never fall.
  std::uint64_t malformed_reports{0};  // that the driver refused
  // Replaced by a newer one before the bus took them: those of a servo that is faster than its bus,
  // and those of a write that was blocked, once it has ended. The mailboxes' writes_superseded.
  std::uint64_t superseded_commands{0};
  bool operator==(const ServoStatus&) const = default;
};

// Of the peer's clock and either way, where the datagrams tell.
struct ClockStatus {
  double offset_s{0};        // peer's clock minus ours
  double offset_error_s{0};  // within so much of that
  double way_there_s{0};     // to the peer
  double way_back_s{0};
  bool operator==(const ClockStatus&) const = default;
};

struct LinkStatus {
  std::string arm;    // at the arm's end; else empty
  std::string world;  // at the world's end; else empty
  std::string peer;
  // "in-process", "udp" (datagrams of 1999; of a listener, both), "thimble".
  std::string kind;
  bool is_up{false};
  double round_trip_s{0};
  std::uint64_t sent{0};
  std::uint64_t received{0};
  std::uint64_t lost{0};
  std::uint64_t rejected{0};
  std::uint64_t stale{0};
  double jitter_s{0};        // mean deviation of the round trip
  std::string last_error{};  // of the carriage; empty: none so far
  // Every kind of trouble by name, with its count: docs/api.md lists them.
  std::vector<std::pair<std::string, std::uint64_t>> events{};
  std::string peer_world{};  // what the peer calls its world; empty: it did not say
  std::string peer_arm{};    // likewise its arm, where that is the far end
  std::optional<ClockStatus> clocks{};
  std::string scheme{};         // that both halves run; empty: not known (yet), or of a listener
  std::string scheme_reason{};  // why that one; empty: there was nothing to choose
  bool operator==(const LinkStatus&) const = default;
};

// World frame, y up.
struct SphereStatus {
  std::array<double, 3> center_m{};
  double radius_m{0};
  double floor_m{0};  // y; matter lies below
  bool operator==(const SphereStatus&) const = default;
};

// World frame: a cube in a cubic room around the origin.
struct BlockStatus {
  std::array<double, 3> center_m{};
  double edge_m{0};
  double room_m{0};
  bool operator==(const BlockStatus&) const = default;
};

// Of a world with pieces, as its board has confirmed it.
struct PiecesStatus {
  std::uint32_t held{0};  // number of the held piece; 0: none
  bool is_free_motion{false};
  std::array<std::uint32_t, 3> grasp_cell{};  // where the grasp point is
  bool operator==(const PiecesStatus&) const = default;
};

struct WorldStatus {
  std::string name;
  std::string source;
  std::array<std::uint32_t, 3> cells{};
  double cell_m{0};
  std::uint32_t probes{0};
  std::uint64_t occupied_cells{0};
  std::uint64_t edits_applied{0};  // since the start
  std::uint64_t edits_waiting{0};
  std::optional<SphereStatus> sphere{};  // of a world that is one
  std::optional<BlockStatus> block{};    // likewise
  std::optional<PiecesStatus> pieces{};  // of a world that has some
  bool operator==(const WorldStatus&) const = default;
};

// The safety lines, where a configuration has them.
struct SafetyStatus {
  std::string chip;
  std::string state;    // "free", "waiting" for a person to clear, or "stopped" by what is wrong
  std::string trouble;  // what is wrong now, in a word; "none"
  std::string message;  // what a person does about it, or about the deadman; empty: nothing
  bool is_deadman_held{false};
  bool must_release_deadman{false};  // closed, and not seen open since the newest stop
  bool is_enable_beating{false};
  std::uint32_t stops{0};  // since the start
  bool operator==(const SafetyStatus&) const = default;
};

struct Status {
  std::string version;
  double uptime_s{0};
  std::vector<std::string> degraded;  // sentences; empty when all is well
  std::vector<ArmStatus> arms;
  std::vector<ServoStatus> servos;
  std::vector<LinkStatus> links;
  std::vector<WorldStatus> worlds;
  std::optional<SafetyStatus> safety{};
  bool operator==(const Status&) const = default;
};

// The document of GET /v1/status, indented, ending in a line break. A number that is not
// finite is written as null, never as NaN.
[[nodiscard]] std::string to_json(const Status& status);

}  // namespace thimble::api
