#pragma once

#include "daemon/api/status.hpp"

namespace thimble::cli {

// A daemon with one arm in the thesis's box, touching its right wall.
inline api::Status sample_status() {
  api::Status out;
  out.version = "0.1.0";
  out.uptime_s = 83.5;
  api::ArmStatus arm;
  arm.name = "right";
  arm.device = "sim:phantom-vintage";
  arm.stands_in_for = "hid:LAB-7";
  arm.newton_per_count = 0.0025;
  arm.max_force_newton = 8.5;
  arm.model = "phantom-vintage";
  arm.state = "active";
  arm.calibration = "done";
  arm.position_m = {0.0148, -0.0035, 0.001};
  arm.force_newton = {-1.25, 0.5, 0.25};
  arm.peak_force_newton = 3.25;
  arm.offset_m = {0, 0, 0};
  arm.felt = {
      {0.0148, -0.0035, 0.001}, 0.001, std::array{0.0148, -0.0035, 0.001}, {{{1, 0, 0}, 0.015}}};
  arm.peak_offset_m = 0.0042;
  arm.contacts = 42;
  arm.is_in_contact = true;
  arm.lease = "configuration";
  arm.constraint_state = "fresh";
  arm.world = "box";
  out.arms = {arm};
  out.servos = {
      {"right", 1000, 83500, 2, {1e-5, 8e-5, 9e-4}, {2e-7, 1e-6, 4e-6}, {1e-6, 2e-6, 3e-6}, false}};
  out.links = {{"right", "", "", "in-process", true, 0.001, 83500, 83499, 0, 0, 0}};
  out.worlds = {{"box", "box:3", {3, 3, 3}, 0.03, 1}};
  return out;
}

}  // namespace thimble::cli
