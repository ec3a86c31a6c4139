#pragma once

#include <memory>
#include <string>

#include "daemon/config/config.hpp"
#include "hal/base/result.hpp"
#include "hal/plugin/sim_model.hpp"
#include "sim/bus/sim_enumerator.hpp"
#include "sim/model/hand/person.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::session {

// A simulated arm on a bus and in a time of its own, held by a simulated person where the
// configuration has one. Each has its own virtual clock, because each servo thread runs one.
//
// Thread: created and destroyed by the control thread while no servo runs on it; clock() is
//         run by the servo thread (through a RealTimeBrake in real time).
// Ownership: outlives the sessions on it.
class SimArm {
 public:
  // Errors: NotFound for an unknown model, naming those there are; InvalidArgument.
  [[nodiscard]] static Result<std::unique_ptr<SimArm>> create(
      const plugin::SimModelRegistry& models, const config::ArmConfig& arm);

  [[nodiscard]] sim::VirtualClock& clock() noexcept { return clock_; }
  [[nodiscard]] sim::SimEnumerator& buses() noexcept { return buses_; }
  // Nobody there to be asked: nothing happens. Thread: any.
  void ask_person_to_calibrate() noexcept;
  [[nodiscard]] plugin::ArmBackend& backend() noexcept { return *backend_; }

 private:
  SimArm() = default;

  sim::VirtualClock clock_;
  sim::SimEnumerator buses_{clock_};
  plugin::ArmBackend* backend_{nullptr};
  std::unique_ptr<sim::Person> person_;
};

}  // namespace thimble::session
