#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "hal/bus/hid_device.hpp"

namespace thimble::phantom {

// What a test says of a HID device and what it sees; outlives the device that a driver owns.
struct HidScript {
  std::optional<bus::HidReport> next;  // what read_newest() gives, once
  IoStatus submit_status{IoStatus::Ok};
  bool is_connected{true};
  std::vector<std::vector<std::uint8_t>> submitted;
  bus::HidCounters counters{};
  MonotonicTime now{};
  std::uint64_t sequence{0};

  // A report that arrives `after` the one before it; fields as on the wire.
  void arrive(const std::array<int, 7>& field, Duration after = std::chrono::milliseconds(1),
              std::size_t size = 14) {
    bus::HidReport report;
    for (std::size_t i = 0; i < 7; ++i) {
      const int bits = field[i] & 0xffff;
      report.bytes[2 * i] = static_cast<std::uint8_t>(bits % 256);
      report.bytes[2 * i + 1] = static_cast<std::uint8_t>(bits / 256);
    }
    report.size = size;
    now = now + after;
    report.arrived_at = now;
    report.sequence = ++sequence;
    next = report;
  }
  // The signed field of the newest submitted report.
  [[nodiscard]] int sent(std::size_t field) const {
    const auto& bytes = submitted.back();
    const int bits = bytes[2 * field] + 256 * bytes[2 * field + 1];
    return bits > 32767 ? bits - 65536 : bits;
  }
};

// A HID device that does what its script says.
class ScriptedHid final : public bus::HidDevice {
 public:
  explicit ScriptedHid(HidScript& script) : script_(script) {}
  IoStatus read_newest(bus::HidReport& out) noexcept override {
    if (!script_.is_connected) return IoStatus::Disconnected;
    if (!script_.next) return IoStatus::NoData;
    out = *script_.next;
    script_.next.reset();
    return IoStatus::Ok;
  }
  IoStatus submit(std::span<const std::uint8_t> report) noexcept override {
    if (!script_.is_connected) return IoStatus::Disconnected;
    script_.submitted.emplace_back(report.begin(), report.end());
    return script_.submit_status;
  }
  [[nodiscard]] bus::HidCounters counters() const noexcept override { return script_.counters; }

 private:
  HidScript& script_;
};

}  // namespace thimble::phantom
