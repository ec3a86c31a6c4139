#include "daemon/app/safety_thread.hpp"

#include <poll.h>

#include <utility>
#include <vector>

#include "daemon/app/servo_threads.hpp"
#include "hal/linux/gpio_lines.hpp"

namespace thimble::app {
namespace {

// Ours: many readings.
constexpr Duration kLetGo = std::chrono::milliseconds(100);

}  // namespace

Result<std::unique_ptr<SafetyThread>> SafetyThread::start(const config::Config& config,
                                                          session::Runtime& runtime,
                                                          const Clock& clock,
                                                          const linux::RealtimeProcess& process) {
  Result<std::unique_ptr<linux::EventFd>> wake = linux::EventFd::create();
  if (!wake) return tl::unexpected(wake.error());
  // The constructor is private, so make_unique cannot reach it.
  std::unique_ptr<SafetyThread> safety(new SafetyThread(config, clock, process, *std::move(wake)));
  safety->session_ = std::make_unique<session::SafetySession>(*config.safety, runtime,
                                                              *safety->chips_, safety->wake_.get());
  linux::RealtimeThreadSettings settings = bus_thread_settings(config.servo);
  settings.name = "safety";
  auto thread = linux::RealtimeThread::start(settings, process.report(),
                                             [self = safety.get()] { self->run(); });
  if (!thread) return tl::unexpected(thread.error());
  safety->thread_ = *std::move(thread);
  return safety;
}

SafetyThread::SafetyThread(const config::Config& config, const Clock& clock,
                           const linux::RealtimeProcess& process,
                           std::unique_ptr<linux::EventFd> wake)
    : clock_(clock), wake_(std::move(wake)) {
  if (!config.safety->is_simulated()) {
    chips_ = std::make_unique<linux::GpioChips>(
        linux::BusSettings{clock, bus_thread_settings(config.servo), process.report()});
    return;
  }
  sim_chip_.emplace(clock, config.safety->chip, config::kSimulatedLines);
  const bool is_closed_high = config.safety->closed_level == config::ClosedLevel::High;
  for (std::size_t i = 0; i < config::kSimulatedLines; ++i) sim_chip_->set_level(i, is_closed_high);
  if (const auto& line = config.safety->deadman)
    sim_hand_ = {std::stoul(*line), is_closed_high, {}};
  chips_ = std::make_unique<sim::SimGpioChips>(std::vector<sim::SimGpioChip*>{&*sim_chip_});
}

SafetyThread::~SafetyThread() {
  is_over_.store(true);
  wake_->signal();
  thread_.reset();
  if (session_) session_->close();
}

void SafetyThread::run() noexcept {
  constexpr int kStep_ms = static_cast<int>(session::SafetySession::kStep.count() / 1'000'000);
  while (!is_over_.load()) {
    session_->step(clock_);
    obey(clock_.now());
    pollfd watched{wake_->fd(), POLLIN, 0};
    ::poll(&watched, 1, kStep_ms);
    wake_->drain();
  }
}

// Whoever holds a simulated deadman lets go when the status asks for it.
void SafetyThread::obey(MonotonicTime now) noexcept {
  if (!sim_hand_) return;
  if (session_->status().must_release_deadman) sim_hand_->lets_go_until = now + kLetGo;
  const bool lets_go = now < sim_hand_->lets_go_until;
  sim_chip_->set_level(sim_hand_->line, sim_hand_->is_closed_high != lets_go);
}

}  // namespace thimble::app
