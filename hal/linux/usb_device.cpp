#include "hal/linux/usb_device.hpp"

#include <unistd.h>

#include <utility>

namespace thimble::linux {

Result<std::unique_ptr<UsbDevice>> UsbDevice::open(int node, const bus::BusDeviceInfo& info,
                                                   const bus::UsbClaim& claim, const Clock& clock,
                                                   const RealtimeThreadSettings& thread,
                                                   const RealtimeReport& process) {
  const auto pipes = bus::resolve_claim(claim, info.endpoints);
  Result<std::unique_ptr<EventFd>> wake = EventFd::create();
  if (!pipes.has_value() || !wake.has_value()) {
    ::close(node);
    const Error& error = pipes.has_value() ? wake.error() : pipes.error();
    return tl::unexpected(error.in(info.address.text));
  }
  Result<SharedDevice> shared = share_node(node);
  if (!shared.has_value()) {
    ::close(node);
    return tl::unexpected(shared.error().in(info.address.text));
  }
  // The constructor is private, so make_unique cannot reach it.
  std::unique_ptr<UsbDevice> device(new UsbDevice(pipes.value(), std::move(wake.value())));
  device->shared_ = std::make_shared<const SharedDevice>(std::move(shared.value()));
  auto transfers = UsbTransfers::open(node, claim.interface_number, *device, clock);
  if (!transfers.has_value()) return tl::unexpected(transfers.error().in(info.address.text));
  device->transfers_ = std::move(transfers.value());
  auto started = RealtimeThread::start(thread, process, [self = device.get()] { self->run(); });
  if (!started.has_value()) return tl::unexpected(started.error().in(info.address.text));
  device->thread_ = std::move(started.value());
  return device;
}

UsbDevice::UsbDevice(std::span<const bus::UsbOpenPipe> pipes, std::unique_ptr<EventFd> wake)
    : UsbMailboxes(pipes), wake_(std::move(wake)) {}

UsbDevice::~UsbDevice() {
  is_over_.store(true);
  wake_->signal();
  thread_.reset();
}

IoStatus UsbDevice::submit(std::uint8_t endpoint, std::span<const std::uint8_t> packet) noexcept {
  const IoStatus status = UsbMailboxes::submit(endpoint, packet);
  if (status == IoStatus::Ok || status == IoStatus::Backlogged) wake_->signal();
  return status;
}

IoStatus UsbDevice::start_control(const bus::UsbControlRequest& request) noexcept {
  const IoStatus status = UsbMailboxes::start_control(request);
  if (status == IoStatus::Ok) wake_->signal();
  return status;
}

void UsbDevice::run() noexcept {
  while (!is_over_.load()) {
    transfers_->serve();
    // Each of the two is a look into the kernel, several in an exchange that would find nothing.
    const UsbTransfers::Woken woken = transfers_->wait(wake_->fd());
    if (woken.is_signalled) wake_->drain();
    if (woken.has_events) transfers_->handle_events();
  }
  // The last is the newest that the servo wanted, zero after a fault: the arm must not be left with
  // an older one.
  transfers_->send_last();
}

}  // namespace thimble::linux
