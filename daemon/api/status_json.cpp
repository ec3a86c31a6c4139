#include <boost/json.hpp>

#include "daemon/api/json_text.hpp"
#include "daemon/api/status.hpp"

namespace thimble::api {
namespace {

namespace json = boost::json;

template <class Number>
json::array vector_of(const std::array<Number, 3>& v) {
  return {v[0], v[1], v[2]};
}

template <class Item, class Convert>
json::array list_of(const std::vector<Item>& items, Convert convert) {
  json::array out;
  for (const Item& item : items) out.emplace_back(convert(item));
  return out;
}

json::object to_value(const FaultStatus& fault) {
  return {{"code", fault.code},
          {"message", fault.message},
          {"at_s", fault.at_s},
          {"recording", fault.recording},
          {"number", fault.number}};
}

json::object to_value(const PlaneStatus& plane) {
  json::object out{{"normal", vector_of(plane.normal)}, {"offset_m", plane.offset_m}};
  if (plane.temperature_kelvin) out["temperature_kelvin"] = *plane.temperature_kelvin;
  return out;
}

json::object to_value(const FeltStatus& felt) {
  json::object out{
      {"position_m", vector_of(felt.position_m)},
      {"lag_s", felt.lag_s},
      {"planes", list_of(felt.planes, [](const PlaneStatus& p) { return to_value(p); })}};
  if (felt.ghost_m) out["ghost_m"] = vector_of(*felt.ghost_m);
  if (felt.ghost_cell) {
    const auto& [x, y, z] = *felt.ghost_cell;
    out["ghost_cell"] = json::array{x, y, z};
  }
  if (felt.pressure_newton) out["pressure_newton"] = vector_of(*felt.pressure_newton);
  return out;
}

json::object to_value(const ArmStatus& arm) {
  return {{"name", arm.name},
          {"device", arm.device},
          {"stands_in_for", arm.stands_in_for},
          {"newton_per_count", arm.newton_per_count},
          {"max_force_newton", arm.max_force_newton},
          {"model", arm.model},
          {"world", arm.world},
          {"state", arm.state},
          {"calibration", arm.calibration},
          {"instruction", arm.instruction},
          {"lease", arm.lease},
          {"lease_number", arm.lease_number},
          {"position_m", vector_of(arm.position_m)},
          {"gimbal_rad", list_of(arm.gimbal_rad, [](double angle_rad) { return angle_rad; })},
          {"force_newton", vector_of(arm.force_newton)},
          {"peak_force_newton", arm.peak_force_newton},
          {"offset_m", vector_of(arm.offset_m)},
          {"felt", to_value(arm.felt)},
          {"peak_offset_m", arm.peak_offset_m},
          {"wished_energy_joule", arm.wished_energy_joule},
          {"contacts", arm.contacts},
          {"is_in_contact", arm.is_in_contact},
          {"constraint_state", arm.constraint_state},
          {"faults", list_of(arm.faults, [](const FaultStatus& f) { return to_value(f); })}};
}

json::object to_value(const Percentiles& percentiles) {
  return {{"p50", percentiles.p50}, {"p99", percentiles.p99}, {"max", percentiles.max}};
}

json::object to_value(const ServoStatus& servo) {
  json::object out{{"arm", servo.arm}};
  if (servo.rate_hz) out["rate_hz"] = *servo.rate_hz;
  out["ticks"] = servo.ticks;
  out["overruns"] = servo.overruns;
  out["is_realtime"] = servo.is_realtime;
  out["wakeup_error_s"] = to_value(servo.wakeup_error_s);
  out["compute_s"] = to_value(servo.compute_s);
  out["exchange_s"] = to_value(servo.exchange_s);
  out["missed_exchanges"] = servo.missed_exchanges;
  out["malformed_reports"] = servo.malformed_reports;
  out["superseded_commands"] = servo.superseded_commands;
  return out;
}

json::object to_value(const LinkStatus& link) {
  json::object out;
  if (!link.arm.empty()) out["arm"] = link.arm;
  if (!link.world.empty()) out["world"] = link.world;
  out["peer"] = link.peer;
  out["kind"] = link.kind;
  out["is_up"] = link.is_up;
  out["round_trip_s"] = link.round_trip_s;
  out["sent"] = link.sent;
  out["received"] = link.received;
  out["lost"] = link.lost;
  out["rejected"] = link.rejected;
  out["stale"] = link.stale;
  out["jitter_s"] = link.jitter_s;
  out["last_error"] = link.last_error;
  json::object events;
  for (const auto& [name, count] : link.events) events[name] = count;
  out["events"] = std::move(events);
  if (!link.peer_world.empty()) out["peer_world"] = link.peer_world;
  if (!link.peer_arm.empty()) out["peer_arm"] = link.peer_arm;
  if (!link.scheme.empty()) out["scheme"] = link.scheme;
  if (!link.scheme_reason.empty()) out["scheme_reason"] = link.scheme_reason;
  if (link.clocks) {
    out["clocks"] = json::object{{"offset_s", link.clocks->offset_s},
                                 {"offset_error_s", link.clocks->offset_error_s},
                                 {"way_there_s", link.clocks->way_there_s},
                                 {"way_back_s", link.clocks->way_back_s}};
  }
  return out;
}

json::object to_value(const WorldStatus& world) {
  json::object out = {{"name", world.name},
                      {"source", world.source},
                      {"cells", vector_of(world.cells)},
                      {"cell_m", world.cell_m},
                      {"probes", world.probes},
                      {"occupied_cells", world.occupied_cells},
                      {"edits_applied", world.edits_applied},
                      {"edits_waiting", world.edits_waiting}};
  if (world.sphere) {
    out["sphere"] = json::object{{"center_m", vector_of(world.sphere->center_m)},
                                 {"radius_m", world.sphere->radius_m},
                                 {"floor_m", world.sphere->floor_m}};
  }
  if (world.block) {
    out["block"] = json::object{{"center_m", vector_of(world.block->center_m)},
                                {"edge_m", world.block->edge_m},
                                {"room_m", world.block->room_m}};
  }
  if (world.pieces) {
    out["pieces"] = json::object{{"held", world.pieces->held},
                                 {"is_free_motion", world.pieces->is_free_motion},
                                 {"grasp_cell", vector_of(world.pieces->grasp_cell)}};
  }
  return out;
}

json::object to_value(const SafetyStatus& safety) {
  return {{"chip", safety.chip},
          {"state", safety.state},
          {"trouble", safety.trouble},
          {"message", safety.message},
          {"is_deadman_held", safety.is_deadman_held},
          {"must_release_deadman", safety.must_release_deadman},
          {"is_enable_beating", safety.is_enable_beating},
          {"stops", safety.stops}};
}

}  // namespace

std::string to_json(const Status& status) {
  json::object out = {
      {"version", status.version},
      {"uptime_s", status.uptime_s},
      {"degraded", list_of(status.degraded, [](const std::string& s) { return s; })},
      {"arms", list_of(status.arms, [](const ArmStatus& a) { return to_value(a); })},
      {"servos", list_of(status.servos, [](const ServoStatus& s) { return to_value(s); })},
      {"links", list_of(status.links, [](const LinkStatus& l) { return to_value(l); })},
      {"worlds", list_of(status.worlds, [](const WorldStatus& w) { return to_value(w); })}};
  if (status.safety) out["safety"] = to_value(*status.safety);
  return to_text(out);
}

}  // namespace thimble::api
