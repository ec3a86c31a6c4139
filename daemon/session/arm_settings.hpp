#pragma once

#include <memory>

#include "daemon/config/config.hpp"
#include "daemon/coupling/arm_coupling.hpp"
#include "daemon/coupling/scheme.hpp"
#include "daemon/link/arm_end_settings.hpp"
#include "daemon/link/endpoint.hpp"
#include "daemon/link/serial_line.hpp"
#include "daemon/servo/servo_loop.hpp"
#include "hal/base/result.hpp"
#include "hal/plugin/driver.hpp"

namespace thimble::session {

struct RigParts;

// What the configuration's words mean to the parts of a session.
//
// Thread: any: pure. Not RT. Ownership: what is returned is the caller's. Errors: the configuration
// has checked every range, so they are about what only the opened arm can tell: InvalidArgument,
// Unsupported.

[[nodiscard]] plugin::DriverSettings driver_settings(const config::ArmConfig& arm);
[[nodiscard]] Result<servo::ServoSettings> servo_settings(const config::ArmConfig& arm,
                                                          const config::ServoConfig& servo,
                                                          const HapticCapabilities& capabilities);
[[nodiscard]] Result<std::unique_ptr<coupling::ArmCoupling>> make_coupling(
    const config::ArmConfig& arm, double cell_m, const HapticCapabilities& capabilities);
[[nodiscard]] coupling::Scheme scheme_of(config::CouplingScheme said);
// Whether an arm of another host's world leaves the scheme to that world: a map where it has one
// for it, else the ghost point. Its arm half is the map's, which without a map is the ghost point,
// bit for bit. Not where a map does not go with the arm: it stands elsewhere, waits for replies, or
// leaves samples out.
[[nodiscard]] bool leaves_scheme_to_world(const config::ArmConfig& arm);
[[nodiscard]] coupling::WorldHalfSettings world_half_settings(const config::CouplingConfig& said);
// What is said of it to a world on another host, and what that one makes of it. Errors: there is no
// such scheme.
[[nodiscard]] link::ThimbleHalf half_of(const config::CouplingConfig& said);
[[nodiscard]] Result<config::CouplingConfig> coupling_of(const link::ThimbleHalf& half);
[[nodiscard]] Result<link::Endpoint> endpoint(const config::UdpEndpoint& said);
[[nodiscard]] link::SerialLine serial_line(const config::SerialEndpoint& said);
[[nodiscard]] link::SendMode send_mode(const config::ArmConfig& arm);
// Of a link to another host. Errors: those of its key file.
[[nodiscard]] Result<link::ArmEndSettings> arm_end_settings(const config::ArmConfig& arm);
[[nodiscard]] link::ImpairmentSettings impairment_settings(
    const std::optional<config::ImpairmentConfig>& impairment);

}  // namespace thimble::session
