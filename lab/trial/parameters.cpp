#include "lab/trial/parameters.hpp"

#include <string>

#include "daemon/coupling/passivity_guard.hpp"
#include "daemon/coupling/slave.hpp"
#include "daemon/coupling/wave_world.hpp"

namespace thimble::lab {
namespace {

using coupling::Scheme;

// Of one case, under its name.
class Listing {
 public:
  Listing(const std::string& name, std::vector<Parameter>& into)
      : prefix_(name + ": "), in_(into) {}

  void number(const char* name, const char* unit, double value) {
    in_.push_back({prefix_ + name, unit, value});
  }
  void time(const char* name, Duration value) { number(name, "s", seconds(value)); }
  void word(const char* name, std::string value) {
    in_.push_back({prefix_ + name, "", std::move(value)});
  }
  void tool(const char* stiffness, const char* damping, const coupling::ToolProperties& of) {
    number(stiffness, "N/m", of.stiffness.newton_per_m);
    number(damping, "N.s/m", of.damping.newton_s_per_m);
  }
  void age(const coupling::ConstraintAgeSettings& of) {
    time("freeze_floor", of.freeze_floor);
    time("fade_floor", of.fade_floor);
    time("fade_time", of.fade_time);
  }

 private:
  std::string prefix_;
  std::vector<Parameter>& in_;
};

void list(const coupling::GhostPointSettings& of, Listing& in) {
  in.tool("stiffness", "damping", {of.stiffness, of.damping});
  in.number("friction", "", of.friction);
  in.number("coordinate_spring", "N/m", of.coordinate_spring.newton_per_m);
  in.number("coordinate_spring_share", "", of.coordinate_spring_share);
  in.time("coordinate_spring_ramp", of.coordinate_spring_ramp);
  in.number("hysteresis", "m", of.hysteresis_m);
  in.number("relaxation", "m/s", of.relaxation_m_per_s);
  in.number("max_offset", "m", of.max_offset_m);
  in.time("redetection_guard", of.redetection_guard);
  in.age(of.age);
}

void list(const coupling::ConstraintPlaneSettings& of, Listing& in) {
  const bool recovers = of.late_walls == coupling::LateWalls::Recovery;
  in.tool("stiffness", "damping", {of.stiffness, of.damping});
  in.number("friction", "", of.friction);
  in.word("late_walls", recovers ? "recovery" : "offset");
  in.time("recovery_time", of.recovery_time);
  in.number("hysteresis", "m", of.hysteresis_m);
  in.number("relaxation", "m/s", of.relaxation_m_per_s);
  in.number("max_offset", "m", of.max_offset_m);
  in.time("redetection_guard", of.redetection_guard);
  in.age(of.age);
}

void list_slave(Listing& in) {
  const coupling::SlaveSettings slave;
  in.number("slave_mass", "kg", slave.mass_kg);
  in.tool("slave_wall_stiffness", "slave_wall_damping", slave.wall);
}

void list(const coupling::SpringDamperSettings& of, Listing& in) {
  in.tool("coupling_stiffness", "coupling_damping", of.tool);
  in.word("force_at", of.force_at == coupling::ForceAt::Both ? "both" : "world");
  in.word("softens_with_delay", of.softens_with_delay ? "yes" : "no");
  in.number("master_mass", "kg", of.master_mass_kg);
  in.age(of.age);
  list_slave(in);
}

void list(const coupling::WaveSettings& of, Listing& in) {
  in.number("impedance", "N.s/m", of.impedance.newton_s_per_m);
  in.time("filter", of.filter);
  in.number("filter_share", "", of.filter_share);
  in.age(of.age);
  const coupling::WaveWorldSettings far;
  in.number("controller_stiffness", "N/m", far.stiffness.newton_per_m);
  in.number("return", "1/s", far.return_per_s);
  in.number("return_speed", "m/s", far.return_m_per_s);
  in.number("return_energy", "J", far.return_joule);
  list_slave(in);
}

void list_scheme(const CouplingCase& of, Listing& in) {
  switch (of.scheme) {
    case Scheme::GhostPoint:
    case Scheme::Composite:
      return list(of.settings.ghost_point, in);
    case Scheme::ThesisLiteral:  // its numbers are printed
      return in.age(of.settings.ghost_point.age);
    case Scheme::RemoteForce:
      in.tool("stiffness", "damping", of.settings.remote_force.tool);
      return in.age(of.settings.remote_force.age);
    case Scheme::SpringDamper:
      return list(of.settings.spring_damper, in);
    case Scheme::Wave:
      return list(of.settings.wave, in);
    case Scheme::ConstraintPlane:
      return list(of.settings.constraint_plane, in);
    case Scheme::BufferZone:
      in.tool("stiffness", "damping", of.settings.buffer_zone.tool);
      in.number("buffer", "m", of.world_half.buffer_zone.buffer_m);
      in.word("zone",
              of.world_half.buffer_zone.names == coupling::ZoneNames::Faces ? "faces" : "cells");
      return in.age(of.settings.buffer_zone.age);
  }
}

}  // namespace

std::vector<Parameter> parameters_of(std::span<const CouplingCase> cases) {
  std::vector<Parameter> all;
  for (const CouplingCase& of : cases) {
    Listing in(of.name, all);
    in.word("scheme", std::string(to_string(of.scheme)));
    in.word("mode", of.mode == link::SendMode::LockStep ? "lock-step" : "streamed");
    list_scheme(of, in);
    if (of.deadband_m > 0) in.number("deadband", "m", of.deadband_m);
    if (of.guard == Guard::None) continue;
    const coupling::PassivitySettings guard;
    in.word("passivity", of.guard == Guard::AtHand ? "at the hand" : "two-port");
    in.number("passivity_bound", "J", guard.bound_joule);
    if (of.guard == Guard::AtHand) {
      in.number("passivity_damping", "N.s/m", guard.most.newton_s_per_m);
    }
    in.number("passivity_speed", "m/s", guard.least_m_per_s);
    in.number("passivity_credit", "J", guard.credit_joule);
  }
  return all;
}

std::vector<Parameter> parameters_of(const FingerSettings& finger) {
  std::vector<Parameter> all;
  Listing in("finger", all);
  in.number("mass", "kg", finger.mass_kg);
  in.number("stiffness", "N/m", finger.stiffness_newton_per_m);
  in.number("damping", "N.s/m", finger.damping_newton_s_per_m);
  in.number("friction", "N", finger.friction_newton);
  in.number("most_force", "N", finger.most_newton);
  in.number("reach", "m", finger.reach_m);
  return all;
}

void append(std::vector<Parameter>& to, const std::vector<Parameter>& all) {
  to.insert(to.end(), all.begin(), all.end());
}

}  // namespace thimble::lab
