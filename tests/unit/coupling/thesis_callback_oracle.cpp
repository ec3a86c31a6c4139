#include "thesis_callback_oracle.hpp"

#include <cmath>

// Written axis by axis and phase by phase, as the callback runs, with its types: the wall and
// damping numbers are doubles cast to float at each use, spring and hysteresis are floats,
// and the absolute value is taken in double. No loop, no helper, nothing clever.
namespace thesis_callback_oracle {

float constraint[3];
float adjpos[3];
unsigned char constdir;
float offset[3];

namespace {

const double wall = 0.8;
const double damper = 0.01;
const float spring = static_cast<float>(0.05);
const float hyst = static_cast<float>(0.5);

unsigned char old_constdir;
int tick_count;
bool is_first;

bool blocked_x() {
  return ((constdir & 0x01) && adjpos[0] > constraint[0]) ||
         ((constdir & 0x02) && adjpos[0] < constraint[0]);
}
bool blocked_y() {
  return ((constdir & 0x04) && adjpos[1] > constraint[1]) ||
         ((constdir & 0x08) && adjpos[1] < constraint[1]);
}
bool blocked_z() {
  return ((constdir & 0x10) && adjpos[2] > constraint[2]) ||
         ((constdir & 0x20) && adjpos[2] < constraint[2]);
}

void move_back(float& o) {
  if (std::fabs(static_cast<double>(o)) > static_cast<double>(4 * hyst)) {
    const int sign = (o > 0) ? 1 : -1;
    o = o - (hyst / 2) * static_cast<float>(sign);
  }
}

}  // namespace

void restart() {
  is_first = true;
  tick_count = 0;
}

void callback(const float position[3], const float velocity[3], float force[3]) {
  if (is_first) {
    is_first = false;
    for (int i = 0; i < 3; ++i) {
      offset[i] = 0;
      constraint[i] = 0;
    }
    constdir = 0;
    old_constdir = 0;
  }
  adjpos[0] = position[0] + offset[0];
  adjpos[1] = position[1] + offset[1];
  adjpos[2] = position[2] + offset[2];

  const int kept = constdir & old_constdir;
  const unsigned char news = static_cast<unsigned char>(constdir - kept);
  old_constdir = constdir;
  if ((news & 0x01) && adjpos[0] > constraint[0] + hyst) {
    offset[0] = constraint[0] - position[0] + hyst;
  } else if ((news & 0x02) && adjpos[0] + hyst < constraint[0]) {
    offset[0] = constraint[0] - position[0] + hyst;
  }
  if ((news & 0x04) && adjpos[1] > constraint[1] + hyst) {
    offset[1] = constraint[1] - position[1] + hyst;
  } else if ((news & 0x08) && adjpos[1] + hyst < constraint[1]) {
    offset[1] = constraint[1] - position[1] + hyst;
  }
  if ((news & 0x10) && adjpos[2] > constraint[2] + hyst) {
    offset[2] = constraint[2] - position[2] + hyst;
  } else if ((news & 0x20) && adjpos[2] + hyst < constraint[2]) {
    offset[2] = constraint[2] - position[2] + hyst;
  }
  adjpos[0] = position[0] + offset[0];
  adjpos[1] = position[1] + offset[1];
  adjpos[2] = position[2] + offset[2];

  force[0] = 0;
  force[1] = 0;
  force[2] = 0;
  const float k = static_cast<float>(wall);
  const float b = static_cast<float>(damper);
  if (blocked_x()) {
    force[0] += k * (constraint[0] - adjpos[0]) - b * velocity[0] + spring * offset[0];
  }
  if (blocked_y()) {
    force[1] += k * (constraint[1] - adjpos[1]) - b * velocity[1] + spring * offset[1];
  }
  if (blocked_z()) {
    force[2] += k * (constraint[2] - adjpos[2]) - b * velocity[2] + spring * offset[2];
  }

  if (tick_count % 10 == 0) {
    if (!blocked_x()) move_back(offset[0]);
    if (!blocked_y()) move_back(offset[1]);
    if (!blocked_z()) move_back(offset[2]);
  }
  ++tick_count;
}

}  // namespace thesis_callback_oracle
