#pragma once

#include <string>

#include "sim/export/plug.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::sim {

// What a plug has around it, in virtual time. The machine's clock is one of its own, an hour ahead.
struct ExportBench {
  VirtualClock clock;
  VirtualClock machine{MonotonicTime{std::chrono::hours(1)}};
  ModelLog log{1000};
  Misbehaviour misbehaviour{1};

  [[nodiscard]] PlugSurroundings surroundings() { return {&clock, &machine, &log, &misbehaviour}; }
  [[nodiscard]] std::string lines() const {
    ModelLog::Cursor cursor = log.since({});
    return log.lines(cursor, 1'000'000);
  }
  void run_frames(int frames) {
    for (int i = 0; i < frames; ++i) clock.run_for(std::chrono::milliseconds(1));
  }
};

}  // namespace thimble::sim
