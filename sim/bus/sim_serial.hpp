#pragma once

#include "hal/bus/serial_mailboxes.hpp"

namespace thimble::sim {

class SimSerialPort;

// The host's end of one simulated serial line: the mailboxes that the port serves.
//
// Thread, RT, Errors: as SerialMailboxes; the bus's side is that of the thread that runs the clock.
// Ownership: closes its port's connection when destroyed; the port must outlive it.
class SimSerial final : public bus::SerialMailboxes {
 public:
  explicit SimSerial(SimSerialPort& port) : port_(&port) {}
  ~SimSerial() override;

 private:
  SimSerialPort* port_;
};

}  // namespace thimble::sim
