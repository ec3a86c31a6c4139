#pragma once

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <vector>

#include "sim/bus/sim_enumerator.hpp"
#include "sim/fault/faulty_enumerator.hpp"
#include "sim/time/virtual_clock.hpp"
#include "tests/support/scripted_hid_model.hpp"

namespace thimble::sim {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using test::HidModelScript;
using test::ScriptedHidModel;

constexpr MonotonicTime at_ms(std::int64_t ms) { return {milliseconds(ms)}; }
using OutBytes = std::array<std::uint8_t, ScriptedHidModel::kOutputBytes>;

inline const bus::DeviceAddress kAddress{"sim:scripted"};

// A device that sends its frame's number every frame, behind a cable with a plan.
struct Bench {
  VirtualClock clock;
  SimEnumerator buses{clock};
  FaultyEnumerator faulty{buses, clock};
  std::shared_ptr<HidModelScript> script = std::make_shared<HidModelScript>();
  std::unique_ptr<bus::HidDevice> sut;

  explicit Bench(FaultPlan plan) {
    EXPECT_TRUE(buses.plug(kAddress, std::make_unique<ScriptedHidModel>(script)).has_value());
    for (std::uint8_t i = 1; i <= 200; ++i) {
      script->to_send.push_back(std::vector<std::uint8_t>(ScriptedHidModel::kInputBytes, i));
    }
    faulty.set_plan(kAddress, std::move(plan));
    sut = faulty.open_hid(kAddress).value();
  }
  // Reads once per frame; the frame number of each report that came, 0 where none did.
  std::vector<int> read_frames(int frames) {
    std::vector<int> seen;
    for (int i = 0; i < frames; ++i) {
      clock.run_for(milliseconds(1));
      bus::HidReport report;
      seen.push_back(sut->read_newest(report) == IoStatus::Ok ? report.bytes[0] : 0);
    }
    return seen;
  }
  std::uint64_t injected(FaultKind kind) const { return faulty.injected(kAddress).of(kind); }
};

inline FaultPlan script_of(ScriptedFault fault) {
  FaultPlan plan;
  plan.script.push_back(fault);
  return plan;
}
inline ScriptedFault during(FaultKind kind, std::int64_t from_ms, std::int64_t lasts_ms) {
  ScriptedFault fault;
  fault.kind = kind;
  fault.from = at_ms(from_ms);
  fault.lasts = milliseconds(lasts_ms);
  return fault;
}
inline ScriptedFault for_reports(FaultKind kind, std::uint64_t first, std::uint64_t reports) {
  ScriptedFault fault;
  fault.kind = kind;
  fault.first_report = first;
  fault.reports = reports;
  return fault;
}

}  // namespace thimble::sim
