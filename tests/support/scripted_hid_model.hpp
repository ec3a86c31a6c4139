#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <vector>

#include "hal/plugin/sim_model.hpp"

namespace thimble::test {

// What a ScriptedHidModel saw, and what it is to send; outlives the model.
struct HidModelScript {
  std::deque<std::vector<std::uint8_t>> to_send;  // one per frame; empty: the device NAKs
  std::vector<std::vector<std::uint8_t>> received;
  std::vector<MonotonicTime> received_at;
  std::vector<MonotonicTime> advanced_to;
  int power_cycles{0};
};

// A simulated HID device without firmware: sends what the test says, keeps what it gets.
class ScriptedHidModel final : public plugin::SimHidModel {
 public:
  static constexpr std::size_t kInputBytes = 14;
  static constexpr std::size_t kOutputBytes = 8;
  static constexpr Duration kFrame = std::chrono::milliseconds(1);

  explicit ScriptedHidModel(std::shared_ptr<HidModelScript> script, Duration frame = kFrame)
      : script_(std::move(script)), frame_(frame) {}

  [[nodiscard]] bus::BusDeviceInfo describe() const override {
    bus::BusDeviceInfo info;
    info.kind = bus::BusKind::Hid;
    info.vendor_id = 0x1234;
    info.product_id = 0x0006;
    info.product = "scripted";
    info.input_report_bytes = kInputBytes;
    info.output_report_bytes = kOutputBytes;
    return info;
  }
  [[nodiscard]] Duration frame_period() const noexcept override { return frame_; }
  void advance(MonotonicTime t) noexcept override { script_->advanced_to.push_back(t); }
  void out_report(std::span<const std::uint8_t> bytes) noexcept override {
    script_->received.emplace_back(bytes.begin(), bytes.end());
    script_->received_at.push_back(script_->advanced_to.back());
  }
  std::size_t in_report(std::span<std::uint8_t> out) noexcept override {
    if (script_->to_send.empty()) return 0;
    const std::vector<std::uint8_t> report = std::move(script_->to_send.front());
    script_->to_send.pop_front();
    std::copy_n(report.begin(), std::min(report.size(), out.size()), out.begin());
    return report.size();
  }
  void power_cycle() noexcept override { ++script_->power_cycles; }
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override { return nullptr; }

 private:
  std::shared_ptr<HidModelScript> script_;
  Duration frame_;
};

}  // namespace thimble::test
