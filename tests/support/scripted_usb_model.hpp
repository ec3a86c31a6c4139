#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "hal/plugin/sim_usb_model.hpp"

namespace thimble::test {

// What a ScriptedUsbModel saw, and what it is to do; outlives the model.
struct UsbModelScript {
  using Packet = std::vector<std::uint8_t>;
  // By endpoint: sent in order; empty: the device says Nak. Longer than a packet: it babbles.
  std::map<std::uint8_t, std::deque<Packet>> to_send;
  std::map<std::uint8_t, std::vector<Packet>> received;
  std::map<std::uint8_t, std::vector<MonotonicTime>> received_at;
  std::vector<bus::UsbControlRequest> requests;
  std::vector<std::uint8_t> control_answer;    // of requests from device to host
  std::set<std::uint8_t> deaf;                 // endpoints, 0 among them, that say Nak
  std::multiset<std::uint8_t> stalls_to_come;  // one STALL for each
  MonotonicTime now{};
  MonotonicTime unchanged_until{};
  int advances{0};
  int power_cycles{0};
};

// A simulated USB device without firmware: a bulk and an interrupt endpoint each way.
class ScriptedUsbModel final : public plugin::SimUsbModel {
 public:
  static constexpr std::uint8_t kBulkIn = 0x81;
  static constexpr std::uint8_t kBulkOut = 0x02;
  static constexpr std::uint8_t kInterruptIn = 0x83;
  static constexpr std::uint8_t kInterruptOut = 0x04;
  static constexpr std::uint16_t kBulkBytes = 64;
  static constexpr std::uint16_t kInterruptBytes = 16;

  explicit ScriptedUsbModel(std::shared_ptr<UsbModelScript> script) : script_(std::move(script)) {}

  [[nodiscard]] bus::BusDeviceInfo describe() const override {
    using enum bus::UsbTransferKind;
    bus::BusDeviceInfo info;
    info.vendor_id = 0x0403;
    info.product_id = 0xcb48;
    info.product = "scripted";
    info.endpoints = {{0, kBulkIn, Bulk, kBulkBytes, 0},
                      {0, kBulkOut, Bulk, kBulkBytes, 0},
                      {0, kInterruptIn, Interrupt, kInterruptBytes, 1},
                      {0, kInterruptOut, Interrupt, kInterruptBytes, 1},
                      {1, 0x85, Isochronous, 64, 1}};
    return info;
  }
  [[nodiscard]] MonotonicTime unchanged_until() const noexcept override {
    return script_->unchanged_until;
  }
  void advance(MonotonicTime t) noexcept override {
    script_->now = t;
    ++script_->advances;
  }
  plugin::UsbAnswer control(const bus::UsbControlRequest& request,
                            std::span<std::uint8_t> in) noexcept override {
    if (script_->deaf.contains(0)) return {};
    script_->requests.push_back(request);
    if (takes_stall(0)) return {plugin::UsbHandshake::Stall, 0};
    return answer(script_->control_answer, in);
  }
  plugin::UsbHandshake out_packet(std::uint8_t endpoint,
                                  std::span<const std::uint8_t> bytes) noexcept override {
    if (script_->deaf.contains(endpoint)) return plugin::UsbHandshake::Nak;
    if (takes_stall(endpoint)) return plugin::UsbHandshake::Stall;
    script_->received[endpoint].emplace_back(bytes.begin(), bytes.end());
    script_->received_at[endpoint].push_back(script_->now);
    return plugin::UsbHandshake::Ack;
  }
  plugin::UsbAnswer in_packet(std::uint8_t endpoint,
                              std::span<std::uint8_t> out) noexcept override {
    if (takes_stall(endpoint)) return {plugin::UsbHandshake::Stall, 0};
    std::deque<UsbModelScript::Packet>& waiting = script_->to_send[endpoint];
    if (waiting.empty() || script_->deaf.contains(endpoint)) return {};
    const UsbModelScript::Packet packet = std::move(waiting.front());
    waiting.pop_front();
    return answer(packet, out);
  }
  void power_cycle() noexcept override { ++script_->power_cycles; }
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override { return nullptr; }

 private:
  static plugin::UsbAnswer answer(const UsbModelScript::Packet& bytes,
                                  std::span<std::uint8_t> out) noexcept {
    std::copy_n(bytes.begin(), std::min(bytes.size(), out.size()), out.begin());
    return {plugin::UsbHandshake::Ack, bytes.size()};
  }
  bool takes_stall(std::uint8_t endpoint) noexcept {
    const auto found = script_->stalls_to_come.find(endpoint);
    if (found == script_->stalls_to_come.end()) return false;
    script_->stalls_to_come.erase(found);
    return true;
  }

  std::shared_ptr<UsbModelScript> script_;
};

}  // namespace thimble::test
