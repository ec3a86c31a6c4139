#include "hal/linux/serial_port.hpp"

#include <utility>

namespace thimble::linux {

Result<std::unique_ptr<SerialPort>> SerialPort::open(const std::string& node,
                                                     const bus::DeviceAddress& address,
                                                     const bus::SerialLine& line,
                                                     const BusSettings& settings) {
  Result<std::unique_ptr<EventFd>> wake = EventFd::create();
  if (!wake.has_value()) return tl::unexpected(wake.error().in(address.text));
  // The constructor is private, so make_unique cannot reach it.
  std::unique_ptr<SerialPort> port(new SerialPort(std::move(wake.value())));
  auto transfers = SerialTransfers::open(node, line, *port, settings.clock, port->calls_);
  if (!transfers.has_value()) return tl::unexpected(transfers.error().in(address.text));
  port->transfers_ = std::move(transfers.value());
  Result<SharedDevice> shared = share_node(port->transfers_->node());
  if (!shared.has_value()) return tl::unexpected(shared.error().in(address.text));
  port->shared_ = std::make_shared<const SharedDevice>(std::move(shared.value()));
  auto thread = RealtimeThread::start(settings.thread, settings.process,
                                      [self = port.get()] { self->run(); });
  if (!thread.has_value()) return tl::unexpected(thread.error().in(address.text));
  port->thread_ = std::move(thread.value());
  return port;
}

SerialPort::~SerialPort() {
  is_over_.store(true);
  wake_->signal();
  thread_.reset();
}

IoStatus SerialPort::submit(std::span<const std::uint8_t> message) noexcept {
  const IoStatus status = SerialMailboxes::submit(message);
  if (status == IoStatus::Ok || status == IoStatus::Backlogged) wake_->signal();
  return status;
}

void SerialPort::run() noexcept {
  while (!is_over_.load()) {
    static_cast<void>(transfers_->send());
    const SerialTransfers::Ready ready = transfers_->wait(wake_->fd());
    if (ready.is_woken) wake_->drain();
    if (ready.has_bytes) transfers_->receive();
  }
  // The last is the newest that the servo wanted, zero after a fault: the arm must not be left with
  // an older one.
  transfers_->send_last();
}

}  // namespace thimble::linux
