#include "cli/status_document.hpp"

#include <algorithm>
#include <boost/json.hpp>
#include <cmath>
#include <limits>
#include <optional>

namespace thimble::cli {
namespace {

namespace json = boost::json;

// Ours: more arms, worlds and links than a daemon can be given, and few enough for memory where
// who answers is no daemon.
constexpr std::size_t kMaxElements = 1024;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

const json::value* member(const json::value& value, std::string_view key) {
  const json::object* object = value.if_object();
  return object == nullptr ? nullptr : object->if_contains(key);
}

double as_number(const json::value& value) {
  if (value.is_double()) return value.get_double();
  if (value.is_int64()) return static_cast<double>(value.get_int64());
  if (value.is_uint64()) return static_cast<double>(value.get_uint64());
  return kUnknown;
}

double number(const json::value& value, std::string_view key) {
  const json::value* found = member(value, key);
  return found == nullptr ? kUnknown : as_number(*found);
}

std::optional<std::uint64_t> find_count(const json::value& value, std::string_view key) {
  const json::value* found = member(value, key);
  if (found == nullptr) return {};
  if (found->is_uint64()) return found->get_uint64();
  if (found->is_int64() && found->get_int64() >= 0) {
    return static_cast<std::uint64_t>(found->get_int64());
  }
  return {};
}

// Nothing where it is no number.
std::optional<double> find_number(const json::value& value, std::string_view key) {
  const double found = number(value, key);
  return std::isnan(found) ? std::nullopt : std::optional(found);
}

std::uint64_t count(const json::value& value, std::string_view key) {
  return find_count(value, key).value_or(0);
}

std::optional<std::string> find_text(const json::value& value, std::string_view key) {
  const json::value* found = member(value, key);
  if (found == nullptr || !found->is_string()) return {};
  return std::string(found->get_string());
}

std::string text(const json::value& value, std::string_view key) {
  return find_text(value, key).value_or("");
}

bool flag(const json::value& value, std::string_view key) {
  const json::value* found = member(value, key);
  return found != nullptr && found->is_bool() && found->get_bool();
}

template <class Convert>
auto list(const json::value& value, std::string_view key, Convert convert) {
  std::vector<decltype(convert(value))> out;
  const json::value* found = member(value, key);
  const json::array* array = found == nullptr ? nullptr : found->if_array();
  if (array == nullptr) return out;
  for (std::size_t i = 0; i < std::min(array->size(), kMaxElements); ++i) {
    out.push_back(convert((*array)[i]));
  }
  return out;
}

std::array<double, 3> vector(const json::value& value, std::string_view key) {
  const std::vector<double> numbers = list(value, key, as_number);
  std::array<double, 3> out{kUnknown, kUnknown, kUnknown};
  std::copy_n(numbers.begin(), std::min<std::size_t>(numbers.size(), 3), out.begin());
  return out;
}

api::Percentiles percentiles(const json::value& value, std::string_view key) {
  const json::value* found = member(value, key);
  const json::value none;
  const json::value& source = found == nullptr ? none : *found;
  return {number(source, "p50"), number(source, "p99"), number(source, "max")};
}

std::uint32_t number_of_fault(const json::value& value) {
  const std::uint64_t number = count(value, "number");
  return number <= std::numeric_limits<std::uint32_t>::max() ? static_cast<std::uint32_t>(number)
                                                             : 0;
}

api::FaultStatus fault(const json::value& value) {
  return {text(value, "code"), text(value, "message"), number(value, "at_s"),
          text(value, "recording"), number_of_fault(value)};
}

api::PlaneStatus plane(const json::value& value) {
  api::PlaneStatus out{vector(value, "normal"), number(value, "offset_m")};
  const json::value* found = member(value, "temperature_kelvin");
  const double kelvin = found == nullptr ? kUnknown : as_number(*found);
  if (std::isfinite(kelvin)) out.temperature_kelvin = kelvin;
  return out;
}

// Nothing where it is no place that a cell can have.
std::optional<std::array<std::int32_t, 3>> cell(const json::value& value, std::string_view key) {
  std::array<std::int32_t, 3> out{};
  const std::array<double, 3> said = vector(value, key);
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(std::abs(said[i]) <= 1e6)) return {};
    out[i] = static_cast<std::int32_t>(said[i]);
  }
  return out;
}

api::FeltStatus felt(const json::value& value) {
  api::FeltStatus out{
      vector(value, "position_m"), number(value, "lag_s"), {}, list(value, "planes", plane)};
  if (member(value, "ghost_m") != nullptr) out.ghost_m = vector(value, "ghost_m");
  out.ghost_cell = cell(value, "ghost_cell");
  if (member(value, "pressure_newton") != nullptr) {
    out.pressure_newton = vector(value, "pressure_newton");
  }
  return out;
}

api::ArmStatus arm(const json::value& value) {
  api::ArmStatus out;
  out.name = text(value, "name");
  out.device = text(value, "device");
  out.newton_per_count = number(value, "newton_per_count");
  out.max_force_newton = number(value, "max_force_newton");
  out.stands_in_for = text(value, "stands_in_for");
  out.model = text(value, "model");
  out.state = text(value, "state");
  out.calibration = text(value, "calibration");
  out.instruction = text(value, "instruction");
  out.position_m = vector(value, "position_m");
  out.gimbal_rad = list(value, "gimbal_rad", as_number);
  out.gimbal_rad.resize(std::min<std::size_t>(out.gimbal_rad.size(), 3));
  out.force_newton = vector(value, "force_newton");
  out.peak_force_newton = number(value, "peak_force_newton");
  out.offset_m = vector(value, "offset_m");
  out.wished_energy_joule = number(value, "wished_energy_joule");
  const json::value* const seen = member(value, "felt");
  out.felt = felt(seen == nullptr ? json::value{} : *seen);
  out.peak_offset_m = number(value, "peak_offset_m");
  out.contacts = count(value, "contacts");
  out.faults = list(value, "faults", fault);
  out.is_in_contact = flag(value, "is_in_contact");
  out.lease = text(value, "lease");
  out.lease_number = count(value, "lease_number");
  out.constraint_state = text(value, "constraint_state");
  out.world = text(value, "world");
  return out;
}

api::ServoStatus servo(const json::value& value) {
  return {text(value, "arm"),
          find_number(value, "rate_hz"),
          count(value, "ticks"),
          count(value, "overruns"),
          percentiles(value, "wakeup_error_s"),
          percentiles(value, "compute_s"),
          percentiles(value, "exchange_s"),
          flag(value, "is_realtime")};
}

std::optional<api::ClockStatus> clocks(const json::value& value) {
  const json::value* found = member(value, "clocks");
  if (found == nullptr || !found->is_object()) return {};
  return api::ClockStatus{number(*found, "offset_s"), number(*found, "offset_error_s"),
                          number(*found, "way_there_s"), number(*found, "way_back_s")};
}

api::LinkStatus link(const json::value& value) {
  return {text(value, "arm"),
          text(value, "world"),
          text(value, "peer"),
          text(value, "kind"),
          flag(value, "is_up"),
          number(value, "round_trip_s"),
          count(value, "sent"),
          count(value, "received"),
          count(value, "lost"),
          count(value, "rejected"),
          count(value, "stale"),
          number(value, "jitter_s"),
          text(value, "last_error"),
          {},
          text(value, "peer_world"),
          text(value, "peer_arm"),
          clocks(value),
          text(value, "scheme"),
          text(value, "scheme_reason")};
}

// Nothing where the daemon does not tell of one, or of one that cannot be.
std::optional<api::SphereStatus> sphere(const json::value& value) {
  const json::value* found = member(value, "sphere");
  if (found == nullptr) return {};
  const api::SphereStatus out{vector(*found, "center_m"), number(*found, "radius_m"),
                              number(*found, "floor_m")};
  const double sum = out.center_m[0] + out.center_m[1] + out.center_m[2] + out.floor_m;
  return out.radius_m > 0 && std::isfinite(sum + out.radius_m) ? std::optional(out) : std::nullopt;
}

std::optional<api::BlockStatus> block(const json::value& value) {
  const json::value* found = member(value, "block");
  if (found == nullptr) return {};
  const api::BlockStatus out{vector(*found, "center_m"), number(*found, "edge_m"),
                             number(*found, "room_m")};
  const double sum = out.center_m[0] + out.center_m[1] + out.center_m[2] + out.room_m;
  const bool can_be = out.edge_m > 0 && out.room_m > out.edge_m && std::isfinite(sum);
  return can_be ? std::optional(out) : std::nullopt;
}

// 0 for what cannot be.
std::array<std::uint32_t, 3> cells(const json::value& value, std::string_view key) {
  const std::array<double, 3> said = vector(value, key);
  std::array<std::uint32_t, 3> out{};
  for (std::size_t i = 0; i < 3; ++i) {
    if (said[i] >= 0 && said[i] <= 1e6) out[i] = static_cast<std::uint32_t>(said[i]);
  }
  return out;
}

std::optional<api::PiecesStatus> pieces(const json::value& value) {
  const json::value* found = member(value, "pieces");
  if (found == nullptr || !found->is_object()) return {};
  return api::PiecesStatus{
      static_cast<std::uint32_t>(std::min<std::uint64_t>(count(*found, "held"), 1000000)),
      flag(*found, "is_free_motion"), cells(*found, "grasp_cell")};
}

api::WorldStatus world(const json::value& value) {
  api::WorldStatus out;
  out.name = text(value, "name");
  out.source = text(value, "source");
  out.cells = cells(value, "cells");
  out.cell_m = number(value, "cell_m");
  out.probes = static_cast<std::uint32_t>(std::min<std::uint64_t>(count(value, "probes"), 1000000));
  out.occupied_cells = count(value, "occupied_cells");
  out.edits_applied = count(value, "edits_applied");
  out.edits_waiting = count(value, "edits_waiting");
  out.sphere = sphere(value);
  out.block = block(value);
  out.pieces = pieces(value);
  return out;
}

std::optional<api::SafetyStatus> safety(const json::value& value) {
  const json::value* found = member(value, "safety");
  if (found == nullptr || !found->is_object()) return std::nullopt;
  api::SafetyStatus out;
  out.chip = text(*found, "chip");
  out.state = text(*found, "state");
  out.trouble = text(*found, "trouble");
  out.message = text(*found, "message");
  out.is_deadman_held = flag(*found, "is_deadman_held");
  out.must_release_deadman = flag(*found, "must_release_deadman");
  out.is_enable_beating = flag(*found, "is_enable_beating");
  out.stops = static_cast<std::uint32_t>(
      std::min<std::uint64_t>(count(*found, "stops"), std::numeric_limits<std::uint32_t>::max()));
  return out;
}

json::value parse_bytes(std::string_view bytes) {
  json::error_code error;
  json::value value = json::parse(bytes, error);
  return error ? json::value() : value;
}

}  // namespace

Result<api::Status> parse_status(std::string_view bytes) {
  const json::value value = parse_bytes(bytes);
  api::Status out;
  out.version = text(value, "version");  // any program's object may be without it
  const json::value* arms = member(value, "arms");
  if (out.version.empty() || arms == nullptr || !arms->is_array()) {
    return fail(Errc::Malformed, "the answer is no status document");
  }
  out.uptime_s = number(value, "uptime_s");
  out.degraded = list(value, "degraded", [](const json::value& item) {
    return item.is_string() ? std::string(item.get_string()) : std::string();
  });
  out.arms = list(value, "arms", arm);
  out.servos = list(value, "servos", servo);
  out.links = list(value, "links", link);
  out.worlds = list(value, "worlds", world);
  out.safety = safety(value);
  return out;
}

std::string parse_error_message(std::string_view bytes, std::string_view otherwise) {
  const json::value value = parse_bytes(bytes);
  const json::value* error = member(value, "error");
  const std::string message = error == nullptr ? "" : text(*error, "message");
  return message.empty() ? std::string(otherwise) : message;
}

std::optional<std::string> parse_member(std::string_view bytes, std::string_view key) {
  return find_text(parse_bytes(bytes), key);
}

std::optional<std::uint64_t> parse_count(std::string_view bytes, std::string_view key) {
  return find_count(parse_bytes(bytes), key);
}

std::optional<bool> parse_flag(std::string_view bytes, std::string_view key) {
  const json::value document = parse_bytes(bytes);
  const json::value* said = member(document, key);
  if (said == nullptr || !said->is_bool()) return std::nullopt;
  return said->get_bool();
}

}  // namespace thimble::cli
