#include "daemon/app/status_source.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "daemon/session/arm_instruction.hpp"
#include "daemon/session/arm_settings.hpp"
#include "daemon/world/cam/piece_world.hpp"
#include "drivers/falcon/find_model.hpp"

namespace thimble::app {
namespace {

template <class Vector>
std::array<double, 3> as_array(const Vector& v) {
  return {v.x, v.y, v.z};
}

api::Percentiles percentiles(const servo::TickHistogram& histogram) {
  const servo::TickQuantiles q = histogram.quantiles();
  return {seconds(q.p50), seconds(q.p99), seconds(q.max)};
}

std::string constraint_state(const servo::ServoFrame& frame) {
  if (frame.state != OperatingState::Active) return "none";
  if (frame.is_fading) return "fading";
  return frame.is_frozen ? "frozen" : "fresh";
}

std::vector<api::FaultStatus> faults_of(const servo::ServoSnapshot& snapshot,
                                        const std::string& arm, const StatusContext& context) {
  if (snapshot.fault.code == FaultCode::None) return {};
  api::FaultStatus fault;
  fault.code = to_string(snapshot.fault.code);
  const bool is_start = snapshot.fault.code == FaultCode::Estop && context.safety != nullptr &&
                        context.safety->is_as_started();
  fault.message = is_start ? session::kNotYetCleared : explain(snapshot.fault.code);
  // The fault is stamped in the arm's own time; what a person wants is how long ago it was.
  const Duration ago = snapshot.frame.now - snapshot.fault.at;
  fault.at_s = std::max(0.0, seconds(context.now - context.started - ago));
  fault.recording = context.recordings.find(arm, snapshot.fault);
  fault.number = snapshot.fault.number;
  return {fault};
}

std::vector<double> gimbal_of(const HapticCapabilities& arm, const servo::ServoSnapshot& snapshot) {
  const bool is_measured = arm.joint_count > kFirstGimbalJoint;
  if (!is_measured || snapshot.frame.calibration != CalibrationState::Ok) return {};
  return {snapshot.gimbal_rad.begin(), snapshot.gimbal_rad.end()};
}

// `place`: of the arm's frame in the world, which viewers draw.
api::FeltStatus felt_status(const coupling::FeltHand& felt, Displacement3 place) {
  api::FeltStatus out;
  out.position_m = as_array(felt.hand + place);
  out.lag_s = seconds(felt.lag);
  if (felt.has_ghost) out.ghost_m = as_array(felt.ghost + place);
  if (felt.has_ghost_cell) {
    out.ghost_cell = {felt.ghost_cell.x, felt.ghost_cell.y, felt.ghost_cell.z};
  }
  if (felt.has_pressure) out.pressure_newton = as_array(felt.pressure);
  for (const coupling::ConstraintPlane& plane : felt.planes) {
    out.planes.push_back({as_array(plane.normal), plane.offset_m + dot(plane.normal, place)});
    const double kelvin = plane.surface.temperature_kelvin;
    if (kelvin >= 0) out.planes.back().temperature_kelvin = kelvin;
  }
  return out;
}

// As its driver takes it: what was measured, or what the model is thought to have.
double newton_per_count_of(const session::ArmSession& session) {
  const falcon::FalconModel* model = falcon::find_model(session.device().capabilities().model);
  if (model == nullptr) return 0;
  return session.config().newton_per_count.value_or(model->newton_per_count);
}

api::ArmStatus arm_status(session::ArmRig& rig, std::size_t index, const StatusContext& context) {
  session::ArmSession& session = rig.session();
  const servo::ServoSnapshot& snapshot = session.snapshot();
  const servo::ServoFrame& frame = snapshot.frame;
  api::ArmStatus arm;
  const auto& [x, y, z] = session.config().place_m;
  const Displacement3 place{x, y, z};
  arm.name = session.config().name;
  arm.device = session.config().device;
  const session::AwaitedArm* const awaited = rig.awaited();
  if (awaited != nullptr && awaited->has_stand_in()) arm.stands_in_for = awaited->arm().device;
  arm.newton_per_count = newton_per_count_of(session);
  arm.max_force_newton = session.loop().settings().limiter.max_force_newton;
  arm.model = session.device().capabilities().model;
  arm.state = to_string(frame.state);
  const bool is_known = !session::will_be_forgotten(session.device().capabilities(), frame);
  arm.calibration = to_string(is_known ? frame.calibration : CalibrationState::Unknown);
  arm.instruction = session::instruction_for(rig);
  if (arm.instruction.empty()) arm.instruction = session::way_in(rig);
  arm.position_m = as_array(frame.tip);
  arm.gimbal_rad = gimbal_of(session.device().capabilities(), snapshot);
  arm.force_newton = as_array(frame.force);
  arm.peak_force_newton = snapshot.peak_force_newton;
  arm.offset_m = as_array(frame.offset);
  arm.felt = felt_status(snapshot.felt, place);
  arm.peak_offset_m = snapshot.peak_offset_m;
  arm.wished_energy_joule = frame.wished_energy_j;
  arm.contacts = snapshot.total_contacts;
  arm.faults = faults_of(snapshot, arm.name, context);
  arm.is_in_contact = frame.is_in_contact;
  arm.lease = to_string(context.leases.holder(index));
  arm.lease_number = context.leases.number(index);
  arm.constraint_state = constraint_state(frame);
  const config::ArmConfig& said = session.config();
  arm.world =
      said.is_listening() ? "" : said.world.value_or(said.peer.value_or(rig.link_status().peer));
  return arm;
}

api::ServoStatus servo_status(session::ArmRig& rig, std::size_t index,
                              const StatusContext& context) {
  session::ArmSession& session = rig.session();
  const servo::ServoSnapshot& snapshot = session.snapshot();
  const servo::ServoLoop& loop = session.loop();
  api::ServoStatus servo;
  servo.arm = session.config().name;
  servo.rate_hz = session.rate_hz();
  servo.ticks = snapshot.frame.tick;
  servo.overruns = snapshot.overruns;
  servo.wakeup_error_s = percentiles(loop.wakeup_error());
  servo.compute_s = percentiles(loop.compute());
  servo.exchange_s = percentiles(loop.exchange());
  servo.missed_exchanges = snapshot.missed_exchanges;
  const DeviceCounters counters = session.device().counters();
  // Not the servo's count of ticks: of one that had a good report besides, only the driver knows
  // the bad one.
  servo.malformed_reports = counters.malformed;
  servo.superseded_commands = counters.commands_superseded;
  servo.is_realtime = context.threads != nullptr && context.threads->is_realtime(index);
  return servo;
}

std::vector<std::pair<std::string, std::uint64_t>> events_of(const link::LinkCounters& c) {
  using Reason = link::RejectReason;
  return {{"accepted", c.accepted},
          {"duplicated", c.duplicated},
          {"reordered", c.reordered},
          {"withheld", c.withheld},
          {"timed_out", c.timed_out},
          {"wrong_size", c.rejected(Reason::WrongSize)},
          {"wrong_peer", c.rejected(Reason::WrongPeer)},
          {"non_finite", c.rejected(Reason::NonFinite)},
          {"out_of_range", c.rejected(Reason::OutOfRange)},
          {"bad_direction", c.rejected(Reason::BadDirection)},
          {"session_refused", c.rejected(Reason::SessionRefused)},
          {"wrong_version", c.rejected(Reason::WrongVersion)},
          {"malformed", c.rejected(Reason::Malformed)},
          {"bad_seal", c.rejected(Reason::BadSeal)},
          {"unencodable_planes", c.unencodable_planes},
          {"send_errors", c.send_errors},
          {"receive_errors", c.receive_errors},
          {"sessions_opened", c.sessions_opened},
          {"sessions_released", c.sessions_released},
          {"injected_lost", c.injected.lost},
          {"injected_duplicated", c.injected.duplicated},
          {"injected_reordered", c.injected.reordered}};
}

api::LinkStatus link_status(const link::LinkStatus& from) {
  api::LinkStatus out;
  out.peer = from.peer;
  out.is_up = from.is_up;
  out.round_trip_s = seconds(from.round_trip);
  out.sent = from.counters.sent;
  out.received = from.counters.received;
  out.lost = from.counters.lost;
  out.rejected = from.counters.rejected();
  out.stale = from.counters.stale;
  out.jitter_s = seconds(from.jitter);
  out.last_error = from.last_error;
  out.events = events_of(from.counters);
  out.peer_world = from.world;
  out.peer_arm = from.arm;
  out.scheme = from.scheme;
  out.scheme_reason = from.scheme_reason;
  if (from.clocks) {
    out.clocks = {seconds(from.clocks->offset), seconds(from.clocks->offset_error),
                  seconds(from.clocks->way_there), seconds(from.clocks->way_back)};
  }
  return out;
}

std::uint32_t probes_in(const api::Status& status, const std::string& world) {
  return static_cast<std::uint32_t>(
      std::count_if(status.links.begin(), status.links.end(), [&](const api::LinkStatus& link) {
        return link.world == world && !link.arm.empty() && link.is_up;
      }));
}

api::WorldStatus world_status(const session::WorldHost& host) {
  const world::WorldInfo& info = host.world().info();
  api::WorldStatus world;
  world.name = host.name();
  world.source = info.source;
  world.cells = info.cells;
  world.cell_m = info.cell_m;
  if (info.sphere) {
    world.sphere = {as_array(info.sphere->center), info.sphere->radius_m, info.sphere->floor_m};
  }
  if (info.block) {
    const Position3 center = host.world().block_center().value_or(Position3{});
    world.block = {as_array(center), info.block->edge_m, info.block->room_m};
  }
  if (const world::cam::PieceWorld* pieces = host.pieces()) {
    const world::cam::PieceState& state = pieces->board().state();
    world.pieces = {static_cast<std::uint32_t>(state.held), state.is_free_motion, {}};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      world.pieces->grasp_cell[axis] = static_cast<std::uint32_t>(state.grasp[axis]);
    }
  }
  if (const world::EditQueue* edits = host.edits()) {
    world.occupied_cells = host.world().occupied_cells();
    world.edits_applied = edits->applied();
    world.edits_waiting = edits->waiting();
  }
  return world;
}

api::SafetyStatus safety_status(const session::SafetySession& safety) {
  const safety::ChainStatus chain = safety.status();
  api::SafetyStatus out;
  out.chip = safety.config().chip;
  const bool is_awaited = chain.trouble == safety::ChainTrouble::None;
  out.state = !chain.is_stopped ? "free" : is_awaited ? "waiting" : "stopped";
  out.trouble = to_string(chain.trouble);
  out.message = safety.explanation();
  out.is_deadman_held = chain.is_deadman_held;
  out.must_release_deadman = chain.must_release_deadman;
  out.is_enable_beating = chain.is_enable_beating;
  out.stops = chain.stops;
  return out;
}

api::LinkStatus link_of_arm(session::ArmRig& rig) {
  const config::ArmConfig& said = rig.session().config();
  api::LinkStatus link = link_status(rig.link_status());
  link.arm = said.name;
  link.world = said.world.value_or("");
  const bool is_ours = said.protocol == config::LinkProtocol::Thimble;
  link.kind = !said.is_remote() ? "in-process" : is_ours ? "thimble" : said.line ? "serial" : "udp";
  if (!session::leaves_scheme_to_world(said)) {
    link.scheme = to_string(session::scheme_of(said.coupling.scheme));
  }
  return link;
}

// Where the arm of another host comes to one of this.
void tell_of_guests(const session::ArmHost& host, api::Status& status) {
  for (api::ArmStatus& arm : status.arms) {
    if (arm.name == host.name()) arm.world = host.guest();
  }
  api::LinkStatus link = link_status(host.listener().status());
  link.arm = host.name();
  link.kind = host.listener().has_line() ? "serial" : "udp";
  status.links.push_back(std::move(link));
  for (const link::LinkStatus& session : host.listener().sessions()) {
    api::LinkStatus one = link_status(session);
    one.arm = host.name();
    one.kind = "thimble";
    status.links.push_back(std::move(one));
  }
}

}  // namespace

api::Status collect_status(session::Runtime& runtime, const StatusContext& context) {
  api::Status status;
  status.version = THIMBLE_VERSION;
  status.uptime_s = seconds(context.now - context.started);
  if (context.safety != nullptr) status.safety = safety_status(*context.safety);
  if (context.threads != nullptr) status.degraded = context.threads->missing();
  for (std::size_t i = 0; i < runtime.arms().size(); ++i) {
    session::ArmRig& rig = *runtime.arms()[i];
    status.arms.push_back(arm_status(rig, i, context));
    status.servos.push_back(servo_status(rig, i, context));
    if (const std::string trouble = rig.trouble(); !trouble.empty()) {
      status.degraded.push_back(trouble);
    }
    if (rig.awaited() != nullptr && rig.awaited()->has_stand_in()) {
      status.degraded.push_back(rig.awaited()->sentence());
    }
    const std::uint64_t missed = context.lateness.missed_lately(i);
    if (is_worth_telling(missed, rig.session().loop().settings().period())) {
      status.degraded.push_back("arm '" + rig.session().config().name +
                                "': " + std::to_string(missed) +
                                " servo periods missed in the last 10 s; this machine is busy");
    }
    status.links.push_back(link_of_arm(rig));
  }
  for (const auto& host : runtime.arm_hosts()) tell_of_guests(*host, status);
  for (const auto& host : runtime.worlds()) {
    status.worlds.push_back(world_status(*host));
    if (host->loss()) status.degraded.push_back(*host->loss());
    if (std::string trouble = host->trouble(); !trouble.empty()) {
      status.degraded.push_back(std::move(trouble));
    }
    status.worlds.back().probes = probes_in(status, host->name());
    if (!host->listener_status()) continue;
    api::LinkStatus link = link_status(*host->listener_status());
    link.world = host->name();
    link.kind = host->has_line() ? "serial" : "udp";
    status.links.push_back(link);
    if (!link.peer.empty()) ++status.worlds.back().probes;  // a program of 1999
    for (const link::LinkStatus& session : host->session_statuses()) {
      api::LinkStatus one = link_status(session);
      one.world = host->name();
      one.kind = "thimble";
      if (one.is_up) ++status.worlds.back().probes;
      status.links.push_back(std::move(one));
    }
  }
  return status;
}

}  // namespace thimble::app
