#pragma once

#include <cstdint>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "hal/base/time.hpp"
#include "hal/bus/serial_port.hpp"

namespace thimble::test {

// One implementation of bus::SerialPort together with the far end of its line. Over a real kernel
// run_for() waits for what must come instead of running a virtual clock, so the suite asks what has
// happened, never when, and nothing about where chunks begin and end.
class SerialRig {
 public:
  using Bytes = std::vector<std::uint8_t>;

  virtual ~SerialRig() = default;
  virtual bus::SerialPort& port() = 0;
  virtual void close_port() = 0;
  virtual void device_sends(const Bytes& bytes) = 0;
  virtual Bytes received_by_device() = 0;
  // The device takes nothing until it hears again.
  virtual void set_deaf(bool is_deaf) = 0;
  virtual void unplug() = 0;
  virtual void run_for(Duration duration) = 0;
  // A kernel's driver stands between, which takes one message for a device that takes nothing: it
  // is out then, as far as the port can tell.
  [[nodiscard]] virtual bool has_kernel() const { return false; }
};

// How the suite makes a fresh rig for every test.
struct SerialRigFactory {
  std::string name;
  std::unique_ptr<SerialRig> (*make)();
  friend void PrintTo(const SerialRigFactory& factory, std::ostream* out) { *out << factory.name; }
};

}  // namespace thimble::test
