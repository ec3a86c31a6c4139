#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "daemon/coupling/arm_link.hpp"
#include "daemon/link/arm_end_settings.hpp"
#include "daemon/link/line_port.hpp"
#include "daemon/link/link_counters.hpp"
#include "daemon/link/serial_line.hpp"
#include "hal/base/time.hpp"
#include "hal/rt/wake_signal.hpp"

namespace thimble::link {

// The arm's end of a protocol along a serial line (thesis 3.1.1): LineArmEnd behind a port. Nothing
// that a line or a peer does ends it; a port that is gone, or held by somebody else, is asked for
// again each second, and its trouble is in status().
//
// Thread: arm_end() is for the servo; everything else for the thread that the ports run on.
// RT: not, but for the arm end. Ownership: ports, clock and wake signal must outlive it.
// Errors: none.
class SerialArmLink {
 public:
  struct Settings {
    SerialLine line{};
    ArmEndSettings end{};
  };

  // `wake`: as UdpArmLink::open().
  SerialArmLink(LinePorts& ports, const Clock& clock, const Settings& settings,
                rt::WakeSignal* wake);
  ~SerialArmLink();

  [[nodiscard]] coupling::ArmLink& arm_end() noexcept;
  void on_wake();  // sends what the servo left, when the line is free
  [[nodiscard]] LinkStatus status() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace thimble::link
