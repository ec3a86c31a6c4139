#include "daemon/servo/flight_file.hpp"

#include <array>
#include <cstdio>

namespace thimble::servo {
namespace {

void append_row(std::string& out, const ServoFrame& f) {
  std::array<char, 640> row{};
  // Ends in a zero byte always; 500 characters hold the longest numbers there are.
  std::snprintf(
      row.data(), row.size(),
      "%llu,%.9f,%.9f,%.9f,%s,%s,%s,%s,%s,%.9g,%.9g,%.9g,%.6g,%.6g,%.6g,%.9g,%.9g,%.9g,"
      "%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.4g,%.6g,%.6g,%u,%u,%d,%d,%d,%d,%d\n",
      static_cast<unsigned long long>(f.tick), seconds(f.now.since_epoch), seconds(f.lateness),
      seconds(f.sample_age), std::string(to_string(f.state)).c_str(),
      std::string(to_string(f.calibration)).c_str(), std::string(to_string(f.read_status)).c_str(),
      std::string(to_string(f.write_status)).c_str(), std::string(to_string(f.fault)).c_str(),
      f.tip.x, f.tip.y, f.tip.z, f.velocity.x, f.velocity.y, f.velocity.z, f.offset.x, f.offset.y,
      f.offset.z, f.wish.x, f.wish.y, f.wish.z, f.force.x, f.force.y, f.force.z, f.gain,
      f.generated_energy_j, f.wished_energy_j, f.buttons, f.contacts, f.is_in_contact ? 1 : 0,
      f.is_limited ? 1 : 0, f.is_stale ? 1 : 0, f.is_frozen ? 1 : 0, f.is_fading ? 1 : 0);
  out += row.data();
}

}  // namespace

std::string format_flight(const FlightHeader& header, const std::vector<ServoFrame>& frames) {
  std::string out = "# Thimble flight recording, version 1\n";
  out += "# arm: " + header.arm + "\n# device: " + header.device + "\n";
  out += "# cause: " + std::string(to_string(header.fault.code)) + " at tick " +
         std::to_string(header.fault.tick) + "\n";
  out += "# meaning: " + std::string(explain(header.fault.code)) + "\n";
  if (header.without_room > 0) {
    out +=
        "# later stops that came too fast to be recorded: " + std::to_string(header.without_room) +
        "\n";
  }
  out +=
      "tick,now_s,lateness_s,sample_age_s,state,calibration,read,write,fault,"
      "tip_x_m,tip_y_m,tip_z_m,velocity_x_m_per_s,velocity_y_m_per_s,velocity_z_m_per_s,"
      "offset_x_m,offset_y_m,offset_z_m,wish_x_newton,wish_y_newton,wish_z_newton,"
      "force_x_newton,force_y_newton,force_z_newton,gain,generated_energy_j,wished_energy_j,"
      "buttons,contacts,in_contact,limited,stale,frozen,fading\n";
  for (const ServoFrame& frame : frames) append_row(out, frame);
  return out;
}

}  // namespace thimble::servo
