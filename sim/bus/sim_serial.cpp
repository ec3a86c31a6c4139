#include "sim/bus/sim_serial.hpp"

#include "sim/bus/sim_serial_port.hpp"

namespace thimble::sim {

SimSerial::~SimSerial() { port_->detach(*this); }

}  // namespace thimble::sim
