#include "tests/support/closed_loop.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <utility>

#include "daemon/config/load.hpp"

namespace thimble::test {
namespace {

void replace_models(const std::vector<plugin::SimModelEntry>& entries,
                    plugin::SimModelRegistry& models) {
  if (!entries.empty()) models = {};
  for (const plugin::SimModelEntry& entry : entries) models.add(entry);
}

}  // namespace

std::string hello_text() {
  std::ifstream file(THIMBLE_SOURCE_DIR "/tests/data/hello.toml");
  return {std::istreambuf_iterator<char>(file), {}};
}

ClosedLoop::ClosedLoop(const std::vector<std::string>& overrides, const Setup& setup,
                       const std::vector<plugin::SimModelEntry>& models) {
  replace_models(models, plugins_.models);
  const std::string text = setup.text.empty() ? hello_text() : setup.text;
  config::ConfigResult config = config::parse(text, "closed-loop.toml", overrides);
  if (!config) {
    ADD_FAILURE() << to_string(config.error().front());
    return;
  }
  if (!config->servo.rate_hz) config->servo.rate_hz = 1000;  // one tick for all arms
  if (setup.bring) setup.bring(plugins_);
  for (const Error& refused : plugins_.load(config->daemon.plugins)) {
    ADD_FAILURE() << refused.message;
  }
  session::RigParts parts{plugins_.models, plugins_.drivers};
  parts.world_clock = &world_clock_;
  parts.wrap_sim_bus = [&](bus::BusEnumerator& buses, const Clock& clock) {
    auto cables = std::make_unique<sim::FaultyEnumerator>(buses, clock);
    const bool is_spared = setup.spares_others && !cables_.empty();
    for (const config::ArmConfig& arm : config->arms) {
      if (!is_spared) cables->set_plan({arm.device}, setup.cables);
    }
    cables_.push_back(cables.get());
    return cables;
  };
  parts.wrap_link = setup.wrap_link;
  Result<std::unique_ptr<session::Runtime>> runtime = session::Runtime::create(*config, parts);
  if (!runtime) {
    ADD_FAILURE() << runtime.error().message;
    return;
  }
  runtime_ = *std::move(runtime);
  next_ = now();
}

void ClosedLoop::sleep_until(MonotonicTime t) {
  for (const auto& rig : runtime_->arms()) (void)rig->clock().sleep_until(t);
}

void ClosedLoop::pump() {
  world_clock_.sleep_until(now());
  net_due_ = runtime_->pump(now());
}

void ClosedLoop::pump_until(MonotonicTime t) {
  while (is_network_up_ && net_due_ && *net_due_ < t) {
    sleep_until(*net_due_);
    pump();
  }
  sleep_until(t);
}

void ClosedLoop::tick(Duration late) {
  const Duration period = settings().period();
  next_ = next_ + period;
  pump_until(next_ + late);
  for (const auto& rig : runtime_->arms()) rig->session().loop().tick(late);
  next_ = next_ + late / period * period;
  if (is_network_up_) pump();
  for (const Error& trouble : runtime_->follow_buses(now())) troubles_.push_back(trouble);
}

void ClosedLoop::run(double s, const std::function<void()>& each) {
  for (auto left = std::lround(s * settings().rate_hz); left > 0; --left) {
    tick();
    if (each) each();
  }
}

bool ClosedLoop::run_until(double s, const std::function<bool()>& condition) {
  for (auto left = std::lround(s * settings().rate_hz); left > 0; --left) {
    tick();
    if (condition()) return true;
  }
  return false;
}

void ClosedLoop::run_until_driven() {
  ASSERT_TRUE(run_until(5, [this] { return frame().gain == 1; }));
}

void ClosedLoop::run_until_pressed() {
  run_until_driven();
  MonotonicTime free_at = now();
  ASSERT_TRUE(run_until(10, [this, &free_at] {
    if (!frame().is_in_contact) free_at = now();
    return now() - free_at >= std::chrono::milliseconds(50);
  }));
}

void ClosedLoop::run_until_leaning() {
  run_until_driven();
  sim_arm().backend().push_tip({4.5, 0, 0});
  run(0.6);
  ASSERT_TRUE(frame().is_in_contact);
  ASSERT_GT(norm(truth().motor_force), 1);
}

bus::DeviceAddress ClosedLoop::device() { return {arm().session().config().device}; }
void ClosedLoop::unplug(sim::Supply supply) {
  EXPECT_TRUE(sim_arm().buses().unplug(device(), supply).has_value());
}
void ClosedLoop::replug() { EXPECT_TRUE(sim_arm().buses().replug(device()).has_value()); }
sim::FaultCounts ClosedLoop::injected() { return cables_.front()->injected(device()); }

}  // namespace thimble::test
