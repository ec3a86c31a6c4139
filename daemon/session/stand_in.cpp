#include "daemon/session/stand_in.hpp"

#include <utility>

namespace thimble::session {

Result<config::ArmConfig> stand_in_for(const config::ArmConfig& arm,
                                       const plugin::SimModelRegistry& models) {
  const std::string model = arm.model.value_or("");
  const bool is_loaded_there = models.find(model + "-loaded") != nullptr;
  config::ArmConfig simulated = arm;
  simulated.device = "sim:" + model + (is_loaded_there ? "-loaded" : "");
  simulated.fallback = config::Fallback::None;
  // The file, if any, is for the real one, and so is the scale that was measured on it.
  simulated.firmware.reset();
  simulated.firmware_sha256.reset();
  simulated.newton_per_count.reset();
  if (!simulated.hand) simulated.hand.emplace();
  if (is_loaded_there || models.find(model) != nullptr) return simulated;
  std::string known;
  for (const plugin::SimModelEntry& entry : models.entries()) known += " " + entry.name;
  return fail(Errc::NotFound,
              "no simulated arm of model '" + model + "' can stand in; there are:" + known);
}

void AwaitedArm::on_bus_event(const bus::BusEvent& event) {
  if (event.device.address.text == arm().device) pace_.restart();
}

std::optional<Result<Opened>> AwaitedArm::follow(MonotonicTime now, bool is_resting) {
  if (is_resting && !was_resting_) pace_.restart();
  was_resting_ = is_resting;
  if (!opener_.is_under_way()) {
    if (!pace_.is_due(now)) return std::nullopt;
    pace_.tried(now);
    request_.probe_only = !is_resting;
    opener_.begin(request_, now);
  }
  std::optional<OpenOutcome> outcome = opener_.take();
  late_ = opener_.lateness(now);
  if (!outcome) return std::nullopt;
  const auto* const absent = std::get_if<NotThere>(&*outcome);
  is_there_ = absent == nullptr;
  if (!is_there_) {
    trouble_ = has_stand_in() ? "" : absent->why.in("arm '" + arm().name + "'").message;
    return std::nullopt;
  }
  const bool was_probed = std::holds_alternative<Probed>(*outcome);
  if (is_resting && !was_probed) return opened_of(*std::move(outcome));
  opener_.give_back(*std::move(outcome));
  return std::nullopt;
}

Result<void> AwaitedArm::tell_lateness(MonotonicTime now) {
  Result<void> told = opener_.tell_lateness(now);
  return told ? told : tl::unexpected(told.error().in("arm '" + arm().name + "'"));
}

std::string AwaitedArm::sentence() const {
  const std::string of_arm = "arm '" + arm().name + "': ";
  if (!late_.empty()) return of_arm + late_;
  if (!has_stand_in()) return trouble_;
  const std::string name = of_arm + arm().device;
  if (!is_there_) {
    return name + " is not there; a simulated arm stands in for it (" + stand_in_ + ")";
  }
  if (!trouble_.empty()) return name + " is there but cannot take over: " + trouble_;
  return name + " is there; it takes over as soon as the simulated arm is inactive: thimble " +
         "deactivate " + arm().name;
}

}  // namespace thimble::session
