#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/session/plugins.hpp"
#include "daemon/session/runtime.hpp"
#include "sim/fault/faulty_enumerator.hpp"

namespace thimble::test {

// One arm, "right", in the thesis's box: tests/data/hello.toml.
[[nodiscard]] std::string hello_text();

// A whole session in virtual time: simulated person, arm and bus, the real driver, servo,
// coupling, link and world, made from a configuration as the daemon does.
class ClosedLoop {
 public:
  struct Setup {
    std::string text;                              // empty: hello_text()
    sim::FaultPlan cables;                         // of every arm's bus
    std::function<void(session::Plugins&)> bring;  // drivers and models of the test's own
    bool spares_others{false};                     // all cables but that of the first arm are good
    // As RigParts::wrap_link, in the order of the arms.
    std::function<std::unique_ptr<coupling::ArmLink>(coupling::ArmLink&)> wrap_link{};
  };

  // `overrides` as --set takes them. `models`: empty for those of sim/model/arm.
  ClosedLoop(const std::vector<std::string>& overrides, const Setup& setup,
             const std::vector<plugin::SimModelEntry>& models = {});
  explicit ClosedLoop(const std::vector<std::string>& overrides = {})
      : ClosedLoop(overrides, Setup{}) {}

  [[nodiscard]] session::Runtime& runtime() { return *runtime_; }
  // Arms as the configuration lists them.
  [[nodiscard]] session::ArmRig& arm(std::size_t i = 0) { return *runtime_->arms()[i]; }
  [[nodiscard]] servo::ServoControls& controls() { return arm().session().controls(); }
  [[nodiscard]] session::SimArm& sim_arm(std::size_t i = 0) { return *arm(i).sim_arm(); }
  [[nodiscard]] world::World& world() { return runtime_->worlds().front()->world(); }
  [[nodiscard]] const servo::ServoSnapshot& snapshot(std::size_t i = 0) {
    return arm(i).session().snapshot();
  }
  [[nodiscard]] const servo::ServoFrame& frame(std::size_t i = 0) { return snapshot(i).frame; }
  [[nodiscard]] const servo::ServoSettings& settings() { return arm().session().loop().settings(); }
  [[nodiscard]] plugin::ArmTruth truth(std::size_t i = 0) { return sim_arm(i).backend().truth(); }
  [[nodiscard]] std::string instruction() {
    return std::string(arm().session().device().calibration_instruction());
  }
  // What hot-plug could not do, so far.
  [[nodiscard]] const std::vector<Error>& troubles() const { return troubles_; }
  [[nodiscard]] MonotonicTime now() { return arm().clock().now(); }

  // One servo period, with the net plane served whenever it has something to do. `late`: the
  // servo wakes up that much later; the periods it slept through are skipped.
  void tick(Duration late = {});
  // `each` runs after every tick.
  void run(double s, const std::function<void()>& each = {});
  // Until `condition` holds; false when it did not within `s`.
  bool run_until(double s, const std::function<bool()>& condition);
  // Until the arm is driven at full gain. Fails the test when it never is.
  void run_until_driven();
  // Until it is driven and a wall has pushed on the hand for 50 ms. Fails the test otherwise.
  void run_until_pressed();

  // Until it is driven and a steady push of 4.5 N holds the tip against the wall at +x; needs
  // a hand that stays where it is. Fails the test otherwise.
  void run_until_leaning();

  // While it hears nothing, samples and replies wait: a dead network.
  void set_network_up(bool is_up) { is_network_up_ = is_up; }
  // The cable of the first arm.
  void unplug(sim::Supply supply = sim::Supply::Goes);
  void replug();
  // What was done to the reports of the first arm.
  [[nodiscard]] sim::FaultCounts injected();

 private:
  [[nodiscard]] bus::DeviceAddress device();
  void sleep_until(MonotonicTime t);
  void pump_until(MonotonicTime t);
  void pump();

  session::Plugins plugins_;
  std::vector<sim::FaultyEnumerator*> cables_;  // of the arms' rigs, in their order
  sim::VirtualClock world_clock_;               // of worlds on a board
  std::unique_ptr<session::Runtime> runtime_;
  std::vector<Error> troubles_;
  MonotonicTime next_{};
  std::optional<MonotonicTime> net_due_;
  bool is_network_up_{true};
};

}  // namespace thimble::test
