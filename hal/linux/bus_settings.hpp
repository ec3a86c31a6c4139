#pragma once

#include "hal/base/time.hpp"
#include "hal/linux/realtime_report.hpp"
#include "hal/linux/realtime_thread.hpp"

namespace thimble::linux {

// How the buses' own threads run, and the clock that stamps what arrives.
//
// Those threads have the servo's priority and no CPU of their own (docs/architecture.md): thimbled
// fills in `thread` so. They are not RT: the kernel may hold them up.
//
// Thread: a value; whoever has it. Ownership: the clock must outlive the copies and the buses.
struct BusSettings {
  const Clock& clock;
  RealtimeThreadSettings thread;  // its name, too, but of a GPIO chip's thread, which is "gpio"
  RealtimeReport process;         // what RealtimeProcess reported
};

}  // namespace thimble::linux
