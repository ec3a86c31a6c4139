#pragma once

#include "hal/base/time.hpp"
#include "hal/linux/realtime_report.hpp"
#include "hal/linux/realtime_thread.hpp"

namespace thimble::linux {

// How the buses' own threads run, and the clock that stamps what arrives; it must outlive them.
struct BusSettings {
  const Clock& clock;
  RealtimeThreadSettings thread;
  RealtimeReport process;  // what RealtimeProcess reported
};

}  // namespace thimble::linux
