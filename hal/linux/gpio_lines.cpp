#include "hal/linux/gpio_lines.hpp"

#include <atomic>
#include <utility>

#include "hal/bus/gpio_mailboxes.hpp"
#include "hal/linux/event_fd.hpp"
#include "hal/linux/gpio_transfers.hpp"
#include "hal/linux/realtime_thread.hpp"

namespace thimble::linux {
namespace {

class GpioLines final : public bus::GpioMailboxes {
 public:
  GpioLines(const bus::GpioClaim& claim, rt::WakeSignal* wake, std::unique_ptr<EventFd> submitted)
      : GpioMailboxes(claim.inputs.size(), claim.outputs.size(), wake),
        submitted_(std::move(submitted)) {}
  ~GpioLines() override {
    is_over_.store(true);
    submitted_->signal();
    thread_.reset();
  }
  GpioLines(const GpioLines&) = delete;
  GpioLines& operator=(const GpioLines&) = delete;

  [[nodiscard]] Result<void> start(const std::string& folder, const bus::GpioClaim& claim,
                                   const BusSettings& settings) {
    auto transfers = GpioTransfers::open(folder, claim, *this, settings.clock);
    if (!transfers) return tl::unexpected(transfers.error());
    transfers_ = *std::move(transfers);
    RealtimeThreadSettings thread = settings.thread;
    thread.name = "gpio";
    auto started = RealtimeThread::start(thread, settings.process, [this] { run(); });
    if (!started) return tl::unexpected(started.error());
    thread_ = *std::move(started);
    return {};
  }

  IoStatus set(std::size_t output, bool is_high) noexcept override {
    const IoStatus status = GpioMailboxes::set(output, is_high);
    if (status == IoStatus::Ok || status == IoStatus::Backlogged) submitted_->signal();
    return status;
  }

 private:
  void run() noexcept {
    while (!is_over_.load() && !is_disconnected()) {
      transfers_->wait(submitted_->fd());
      submitted_->drain();
      transfers_->serve();
    }
  }

  std::unique_ptr<EventFd> submitted_;
  std::atomic<bool> is_over_{false};
  std::unique_ptr<GpioTransfers> transfers_;
  std::unique_ptr<RealtimeThread> thread_;  // last: it uses all of the above
};

}  // namespace

Result<std::unique_ptr<bus::GpioLines>> GpioChips::open(const bus::GpioClaim& claim,
                                                        rt::WakeSignal* wake) {
  Result<std::unique_ptr<EventFd>> submitted = EventFd::create();
  if (!submitted) return tl::unexpected(submitted.error());
  auto lines = std::make_unique<GpioLines>(claim, wake, *std::move(submitted));
  if (const Result<void> started = lines->start(folder_, claim, settings_); !started) {
    return tl::unexpected(started.error());
  }
  return lines;
}

}  // namespace thimble::linux
