#include "lab/run/playable.hpp"

#include "hal/bus/device_address.hpp"

namespace thimble::lab {
namespace {

bool is_on_real_board(const config::WorldConfig& world) {
  if (!world.pieces) return false;
  return world.pieces->board == config::PieceBoardKind::Usb ||
         world.pieces->board == config::PieceBoardKind::Pci;
}

}  // namespace

std::vector<std::string> reasons_not_to_play(const config::Config& config) {
  std::vector<std::string> reasons;
  if (config.arms.empty()) reasons.emplace_back("arm: there is none, so nothing would happen");
  for (const config::ArmConfig& arm : config.arms) {
    const std::string name = "arm '" + arm.name + "'";
    if (!bus::is_simulated(arm.device)) {
      reasons.push_back(name + ": device: a real one keeps real time; --set \"arm." + arm.name +
                        ".device='sim:phantom-vintage'\" takes a simulated one");
    }
    if (arm.link) {
      reasons.push_back(name +
                        ": link: another host keeps real time; give it a world of this file");
    }
    if (arm.is_listening()) {
      reasons.push_back(name +
                        ": listen: another host keeps real time; give it a peer of this file");
    }
  }
  for (const config::WorldConfig& world : config.worlds) {
    const std::string name = "world '" + world.name + "'";
    if (world.listen) {
      reasons.push_back(name + ": listen: arms of other hosts keep real time; leave it out");
    }
    if (is_on_real_board(world)) {
      reasons.push_back(
          name + ": pieces.board: a real one keeps real time; \"sim\" and \"sim-usb\" do not");
    }
  }
  if (config.safety) {
    reasons.emplace_back("safety: its lines are watched in real time; leave the table out");
  }
  return reasons;
}

}  // namespace thimble::lab
