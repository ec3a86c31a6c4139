#pragma once

#include <span>

#include "hal/bus/usb_mailboxes.hpp"

namespace thimble::sim {

class SimUsbPort;

// The host's end of one simulated USB connection: the mailboxes that the port serves.
//
// Thread, RT, Errors: as UsbMailboxes; the bus's side is that of the thread that runs the clock.
// Ownership: closes its port's connection when destroyed; the port must outlive it.
class SimUsb final : public bus::UsbMailboxes {
 public:
  SimUsb(SimUsbPort& port, std::span<const bus::UsbOpenPipe> pipes) noexcept
      : UsbMailboxes(pipes), port_(&port) {}
  ~SimUsb() override;

 private:
  SimUsbPort* port_;
};

}  // namespace thimble::sim
