#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "sim/bus/sim_enumerator.hpp"
#include "sim/fault/faulty_enumerator.hpp"
#include "sim/time/virtual_clock.hpp"
#include "tests/support/scripted_usb_model.hpp"

namespace thimble::sim {

using test::ScriptedUsbModel;
using test::UsbModelScript;
using Packet = UsbModelScript::Packet;

inline constexpr std::uint8_t kIn = ScriptedUsbModel::kBulkIn;
inline constexpr std::uint8_t kNewestIn = ScriptedUsbModel::kInterruptIn;
inline constexpr std::uint8_t kOut = ScriptedUsbModel::kBulkOut;
inline const bus::DeviceAddress kUsbAddress{"sim:scripted"};

// A device behind a cable with a plan.
struct UsbBench {
  VirtualClock clock;
  SimEnumerator buses{clock};
  FaultyEnumerator faulty{buses, clock};
  std::shared_ptr<UsbModelScript> script = std::make_shared<UsbModelScript>();
  std::unique_ptr<bus::UsbDevice> sut;

  explicit UsbBench(FaultPlan plan) {
    EXPECT_TRUE(buses.plug(kUsbAddress, std::make_unique<ScriptedUsbModel>(script)).has_value());
    faulty.set_plan(kUsbAddress, std::move(plan));
    open();
  }
  void open() {
    bus::UsbClaim claim;
    claim.pipes.push_back({kIn, bus::UsbDelivery::Every});
    claim.pipes.push_back({kNewestIn, bus::UsbDelivery::Newest});
    claim.pipes.push_back({kOut, bus::UsbDelivery::Newest});
    sut = faulty.open_usb(kUsbAddress, claim).value();
  }
  // The first byte of all that waits on a pipe; 0 for an empty packet.
  std::vector<int> read_all(std::uint8_t endpoint) {
    std::vector<int> seen;
    bus::UsbPacket packet;
    while (sut->read(endpoint, packet) == IoStatus::Ok) {
      seen.push_back(packet.size == 0 ? 0 : packet.bytes[0]);
    }
    return seen;
  }
  // The device sends `packets` packets, numbered from 1, one per millisecond; what is read then.
  std::vector<std::vector<int>> stream(int packets) {
    std::vector<std::vector<int>> seen;
    for (int i = 1; i <= packets; ++i) {
      script->to_send[kIn].push_back(Packet(8, static_cast<std::uint8_t>(i)));
      clock.run_for(std::chrono::milliseconds(1));
      seen.push_back(read_all(kIn));
    }
    return seen;
  }
  // Submits packets numbered from 1, one per millisecond; returns what the device got.
  std::vector<Packet> submit(int packets) {
    for (int i = 1; i <= packets; ++i) {
      sut->submit(kOut, Packet(8, static_cast<std::uint8_t>(i)));
      clock.run_for(std::chrono::milliseconds(1));
    }
    return script->received[kOut];
  }
  IoStatus transact(const bus::UsbControlRequest& request, bus::UsbControlReply& reply) {
    EXPECT_EQ(sut->start_control(request), IoStatus::Ok);
    clock.run_for(std::chrono::milliseconds(1));
    return sut->read_control(reply);
  }
  std::uint64_t injected(FaultKind kind) const { return faulty.injected(kUsbAddress).of(kind); }
};

inline FaultPlan plan_of(FaultKind kind, std::uint64_t first, std::uint64_t reports = 1) {
  ScriptedFault fault;
  fault.kind = kind;
  fault.first_report = first;
  fault.reports = reports;
  FaultPlan plan;
  plan.script.push_back(fault);
  return plan;
}
inline FaultPlan plan_during(FaultKind kind, std::int64_t from_ms, std::int64_t lasts_ms) {
  ScriptedFault fault;
  fault.kind = kind;
  fault.from = MonotonicTime{std::chrono::milliseconds(from_ms)};
  fault.lasts = std::chrono::milliseconds(lasts_ms);
  FaultPlan plan;
  plan.script.push_back(fault);
  return plan;
}
inline bus::UsbControlRequest request_for_data() {
  bus::UsbControlRequest request;
  request.request_type = 0xc0;
  request.length = 8;
  return request;
}

}  // namespace thimble::sim
