#include "daemon/app/servo_threads.hpp"

#include <algorithm>
#include <utility>

#include "daemon/servo/servo_runner.hpp"

namespace thimble::app {
namespace {

linux::RealtimeThreadSettings thread_settings(const config::ServoConfig& servo,
                                              const std::string& arm) {
  linux::RealtimeThreadSettings settings = bus_thread_settings(servo);
  settings.name = "servo-" + arm;
  if (servo.cpu) settings.cpu = static_cast<unsigned>(*servo.cpu);
  return settings;
}

}  // namespace

linux::RealtimeThreadSettings bus_thread_settings(const config::ServoConfig& servo) {
  linux::RealtimeThreadSettings settings;
  settings.name = "bus";
  settings.policy = servo.realtime == config::Realtime::Required
                        ? linux::RealtimePolicy::Required
                        : linux::RealtimePolicy::BestEffort;
  settings.priority = servo.priority;
  return settings;
}

Result<std::unique_ptr<ServoThreads>> ServoThreads::start(const config::ServoConfig& servo,
                                                          session::Runtime& runtime,
                                                          const linux::RealtimeProcess& process) {
  // The constructor is private, so make_unique cannot reach it.
  std::unique_ptr<ServoThreads> threads(new ServoThreads(servo, runtime, process));
  for (std::size_t i = 0; i < runtime.arms().size(); ++i) {
    threads->servos_.push_back(std::make_unique<Servo>());
    const Result<void> started = threads->start(i);
    if (!started) return tl::unexpected(started.error());
  }
  return threads;
}

Result<void> ServoThreads::start(std::size_t arm) {
  session::ArmRig* const rig = runtime_.arms().at(arm).get();
  Servo* const servo = servos_.at(arm).get();
  servo->is_stopping = false;
  Result<std::unique_ptr<linux::RealtimeThread>> thread = linux::RealtimeThread::start(
      thread_settings(config_, rig->session().config().name), process_.report(),
      [rig, servo] { servo::run_servo(rig->session().loop(), rig->clock(), servo->is_stopping); });
  if (!thread) return tl::unexpected(thread.error());
  servo->report = (*thread)->report();
  servo->thread = *std::move(thread);
  return {};
}

ServoThreads::~ServoThreads() { stop(); }

void ServoThreads::stop() {
  // All at once: each takes as long as its ramp.
  for (std::size_t i = 0; i < servos_.size(); ++i) {
    runtime_.arms()[i]->session().controls().want_active = false;
    servos_[i]->is_stopping = true;
  }
  for (const auto& servo : servos_) servo->thread.reset();
}

void ServoThreads::stop(std::size_t arm) {
  runtime_.arms().at(arm)->session().controls().want_active = false;
  servos_.at(arm)->is_stopping = true;
  servos_.at(arm)->thread.reset();
}

bool ServoThreads::is_realtime(std::size_t arm) const {
  return arm < servos_.size() && servos_[arm]->report.has_fifo;
}

std::vector<std::string> ServoThreads::missing() const {
  std::vector<std::string> all;
  for (const auto& servo : servos_) {
    for (const std::string& right : servo->report.missing) {
      if (std::find(all.begin(), all.end(), right) == all.end()) all.push_back(right);
    }
  }
  return all;
}

bool ServoThreads::have_all_ticked() {
  bool has_all = true;
  for (std::size_t i = 0; i < servos_.size(); ++i) {
    const std::uint64_t tick = runtime_.arms()[i]->session().snapshot().frame.tick;
    has_all = has_all && tick != servos_[i]->ticks_seen;
    servos_[i]->ticks_seen = tick;
  }
  return has_all;
}

}  // namespace thimble::app
