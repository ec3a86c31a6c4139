#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "hal/plugin/sim_serial_model.hpp"

namespace thimble::test {

// What a ScriptedSerialModel saw, and what it is to do; outlives the model.
struct SerialModelScript {
  std::deque<std::uint8_t> to_send;
  std::vector<std::uint8_t> received;
  std::vector<MonotonicTime> received_at;  // of each byte
  bool is_deaf{false};                     // takes nothing
  std::uint32_t bit_per_s{0};
  MonotonicTime now{};
  int power_cycles{0};
};

// A simulated serial device without firmware.
class ScriptedSerialModel final : public plugin::SimSerialModel {
 public:
  explicit ScriptedSerialModel(std::shared_ptr<SerialModelScript> script)
      : script_(std::move(script)) {}

  [[nodiscard]] bus::BusDeviceInfo describe() const override {
    bus::BusDeviceInfo info;
    info.vendor_id = 0x16c0;
    info.product_id = 0x0483;
    info.product = "scripted";
    return info;
  }
  [[nodiscard]] std::uint32_t bit_per_s() const noexcept override { return script_->bit_per_s; }
  void advance(MonotonicTime t) noexcept override { script_->now = t; }
  std::size_t take(std::span<const std::uint8_t> bytes) noexcept override {
    if (script_->is_deaf) return 0;
    script_->received.insert(script_->received.end(), bytes.begin(), bytes.end());
    script_->received_at.insert(script_->received_at.end(), bytes.size(), script_->now);
    return bytes.size();
  }
  std::size_t give(std::span<std::uint8_t> out) noexcept override {
    const std::size_t size = std::min(out.size(), script_->to_send.size());
    const auto end = script_->to_send.begin() + static_cast<std::ptrdiff_t>(size);
    std::copy(script_->to_send.begin(), end, out.begin());
    script_->to_send.erase(script_->to_send.begin(), end);
    return size;
  }
  void power_cycle() noexcept override { ++script_->power_cycles; }
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override { return nullptr; }

 private:
  std::shared_ptr<SerialModelScript> script_;
};

}  // namespace thimble::test
