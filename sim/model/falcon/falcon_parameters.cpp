#include "sim/model/falcon/falcon_parameters.hpp"

#include <numbers>

#include "drivers/falcon/falcon_models.hpp"
#include "drivers/falcon/falcon_wire.hpp"

namespace thimble::sim {

FalconParameters falcon_parameters() {
  const falcon::FalconModel& model = falcon::kFalconModels[0];
  FalconParameters p;
  p.azimuth_rad = model.leg_azimuth_rad;
  p.base_radius_m = model.base_radius_m;
  p.base_shift_m = model.base_shift_m;
  p.crank_m = model.crank_m;
  p.rods_m = model.rods_m;
  p.grip_radius_m = model.grip_radius_m;
  p.rods_to_links_m = model.knee_m + model.ankle_m;
  p.grip_shift_m = model.grip_shift_m;
  p.drive_ratio = model.drum_diameter_m / model.capstan_diameter_m;
  p.counts_per_rad = model.counts_per_motor_rev * p.drive_ratio / (2 * std::numbers::pi);
  p.home_rad = model.home_angle_rad;
  p.motor_sign = model.motor_direction;
  p.origin_m = model.origin_m;
  p.largest_counts = falcon::wire::kMaxMotor_counts;
  return p;
}

}  // namespace thimble::sim
