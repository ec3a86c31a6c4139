#include "lab/run/playable.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "daemon/config/endpoint.hpp"
#include "hal/bus/device_address.hpp"

namespace thimble::lab {
namespace {

bool is_on_real_board(const config::WorldConfig& world) {
  if (!world.pieces) return false;
  return world.pieces->board == config::PieceBoardKind::Usb ||
         world.pieces->board == config::PieceBoardKind::Pci;
}

// `file`: of the arm.
constexpr double kRateOfNobody_hz = 1000;  // ours: what the thesis had

void judge(const config::ArmConfig& arm, std::size_t file, const std::vector<PlayedFile>& files,
           std::vector<std::string>& reasons) {
  const std::string name = "arm '" + arm.name + "'";
  if (!bus::is_simulated(arm.device)) {
    reasons.push_back(name + ": device: a real one keeps real time; --set \"arm." + arm.name +
                      ".device='sim:phantom-vintage'\" takes a simulated one");
  }
  if (arm.link && !is_heard(*arm.link, files)) {
    reasons.push_back(name + ": link: nobody listens at " + config::to_string(*arm.link) +
                      "; give the configuration of that host, too");
  }
  if (!arm.line) return;
  const std::size_t ends = ends_at(arm.line->node, files);
  if (!is_heard(*arm.line, file, files)) {
    reasons.push_back(name + ": link: nobody listens at " + config::to_string(*arm.line) +
                      "; give the configuration of that host, too, with the same device there");
  } else if (ends > 2) {
    reasons.push_back(name + ": link: " + std::to_string(ends) + " ends are at " + arm.line->node +
                      ", and a line has two; give each line a device of its own with --set");
  }
}

void judge(const config::WorldConfig& world, std::vector<std::string>& reasons) {
  const std::string name = "world '" + world.name + "'";
  if (is_on_real_board(world)) {
    reasons.push_back(name +
                      ": pieces.board: a real one keeps real time; \"sim\" and \"sim-usb\" do not");
  }
}

}  // namespace

double servo_rate_hz(const std::vector<PlayedFile>& files) {
  for (const PlayedFile& file : files) {
    if (file.config.servo.rate_hz) return *file.config.servo.rate_hz;
  }
  return kRateOfNobody_hz;
}

std::vector<std::string> reasons_not_to_play(const std::vector<PlayedFile>& files) {
  std::vector<std::string> all;
  const bool has_arm = std::any_of(files.begin(), files.end(),
                                   [](const auto& of) { return !of.config.arms.empty(); });
  if (!has_arm) all.emplace_back("arm: there is none, so nothing would happen");
  const double rate_hz = servo_rate_hz(files);
  for (std::size_t i = 0; i < files.size(); ++i) {
    const PlayedFile& file = files[i];
    std::vector<std::string> reasons;
    for (const config::ArmConfig& arm : file.config.arms) judge(arm, i, files, reasons);
    for (const config::WorldConfig& world : file.config.worlds) judge(world, reasons);
    if (file.config.servo.rate_hz.value_or(rate_hz) != rate_hz) {
      reasons.emplace_back(
          "servo.rate_hz: another than that of a file before it; all are driven "
          "by one clock");
    }
    for (std::string& reason : reasons) {
      all.push_back(files.size() > 1 ? file.name + ": " + std::move(reason) : std::move(reason));
    }
  }
  return all;
}

}  // namespace thimble::lab
