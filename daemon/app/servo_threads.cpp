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
  std::unique_ptr<ServoThreads> threads(new ServoThreads(runtime));
  threads->ticks_seen_.resize(runtime.arms().size());
  for (const auto& arm : runtime.arms()) {
    session::ArmRig* const rig = arm.get();
    const std::atomic<bool>& is_stopping = threads->is_stopping_;
    Result<std::unique_ptr<linux::RealtimeThread>> thread = linux::RealtimeThread::start(
        thread_settings(servo, rig->session().config().name), process.report(),
        [rig, &is_stopping] {
          servo::run_servo(rig->session().loop(), rig->clock(), is_stopping);
        });
    if (!thread) return tl::unexpected(thread.error());
    threads->reports_.push_back((*thread)->report());
    threads->threads_.push_back(*std::move(thread));
  }
  return threads;
}

ServoThreads::~ServoThreads() { stop(); }

void ServoThreads::stop() {
  for (const auto& arm : runtime_.arms()) arm->session().controls().want_active = false;
  is_stopping_ = true;
  threads_.clear();
}

bool ServoThreads::is_realtime(std::size_t arm) const {
  return arm < reports_.size() && reports_[arm].has_fifo;
}

std::vector<std::string> ServoThreads::missing() const {
  std::vector<std::string> all;
  for (const linux::RealtimeReport& report : reports_) {
    for (const std::string& right : report.missing) {
      if (std::find(all.begin(), all.end(), right) == all.end()) all.push_back(right);
    }
  }
  return all;
}

bool ServoThreads::have_all_ticked() {
  bool has_all = true;
  for (std::size_t i = 0; i < ticks_seen_.size(); ++i) {
    const std::uint64_t tick = runtime_.arms()[i]->session().snapshot().frame.tick;
    has_all = has_all && tick != ticks_seen_[i];
    ticks_seen_[i] = tick;
  }
  return has_all;
}

}  // namespace thimble::app
