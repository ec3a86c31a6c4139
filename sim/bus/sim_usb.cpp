#include "sim/bus/sim_usb.hpp"

#include "sim/bus/sim_usb_port.hpp"

namespace thimble::sim {

SimUsb::~SimUsb() { port_->detach(*this); }

}  // namespace thimble::sim
