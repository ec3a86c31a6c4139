#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/bus/sim_enumerator.hpp"
#include "sim/model/falcon/falcon_arm_model.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::sim {

// A host with a simulated Falcon on a simulated bus: a driver's part, spelled out in numbers.
class FalconHost {
 public:
  using Bytes = std::vector<std::uint8_t>;

  explicit FalconHost(const FalconParameters& parameters = falcon_parameters()) {
    auto model = std::make_unique<FalconArmModel>(parameters);
    arm_ = model.get();
    (void)buses_.plug({"sim:falcon"}, std::move(model));
    bus::UsbClaim claim;
    claim.pipes.push_back({0x81, bus::UsbDelivery::Every});
    claim.pipes.push_back({0x02, bus::UsbDelivery::Every});
    device_ = buses_.open_usb({"sim:falcon"}, claim).value();
  }

  [[nodiscard]] FalconArmModel& arm() { return *arm_; }
  [[nodiscard]] SimEnumerator& buses() { return buses_; }
  [[nodiscard]] VirtualClock& clock() { return clock_; }

  void wait(Duration time) { clock_.run_for(time); }
  bus::UsbOutcome set(std::uint8_t request, std::uint16_t value) {
    device_->start_control({.request = request, .value = value});
    bus::UsbControlReply reply;
    while (device_->read_control(reply) != IoStatus::Ok) wait(std::chrono::microseconds(125));
    return reply.outcome;
  }
  void write(const Bytes& bytes) { device_->submit(0x02, bytes); }
  void write(const std::string& text) { write(Bytes(text.begin(), text.end())); }
  // What came, without the bytes of status.
  Bytes read() {
    Bytes all;
    bus::UsbPacket packet;
    while (device_->read(0x81, packet) == IoStatus::Ok) {
      ++packets_;
      all.insert(all.end(), packet.bytes.begin() + 2,
                 packet.bytes.begin() + static_cast<std::ptrdiff_t>(packet.size));
    }
    return all;
  }
  Bytes read_for(Duration time) {
    Bytes all;
    for (Duration passed{}; passed < time; passed += std::chrono::milliseconds(1)) {
      wait(std::chrono::milliseconds(1));
      const Bytes more = read();
      all.insert(all.end(), more.begin(), more.end());
    }
    return all;
  }
  // Up to the boot ROM; false: no answer.
  bool greet() {
    for (const auto& [request, value] :
         std::array<std::array<std::uint16_t, 2>, 9>{{{0, 1},
                                                      {0, 2},
                                                      {9, 16},
                                                      {3, 0x4138},
                                                      {4, 8},
                                                      {2, 0},
                                                      {1, 0x0200},
                                                      {1, 0x0100},
                                                      {1, 0x0101}}}) {
      set(static_cast<std::uint8_t>(request), value);
    }
    Bytes answer;
    for (int question = 0; question < 100 && answer.empty(); ++question) {
      write(Bytes{0x0a, 0x43, 0x0d});
      answer = read_for(std::chrono::milliseconds(40));
    }
    set(1, 0x0100);
    set(3, 0x0015);
    return answer == Bytes{0x0a, 0x44, 0x2c, 0x0d};
  }
  // False: an echo is missing or another.
  bool upload(const Bytes& image) {
    write(Bytes{0x41});
    bool is_same = read_for(std::chrono::milliseconds(40)) == Bytes{0x41};
    for (std::size_t at = 0; at < image.size(); at += 62) {
      const auto first = image.begin() + static_cast<std::ptrdiff_t>(at);
      const Bytes chunk(
          first, first + static_cast<std::ptrdiff_t>(std::min<std::size_t>(62, image.size() - at)));
      write(chunk);
      is_same = read_for(std::chrono::milliseconds(24)) == chunk && is_same;
    }
    wait(std::chrono::milliseconds(20));
    return is_same;
  }
  void go_to_run_mode(std::uint16_t latency_ms = 1) {
    set(9, latency_ms);
    set(3, 0x0002);
    set(0, 1);
    set(0, 2);
    read();
  }
  // One exchange in a millisecond; nothing: no reply came in it.
  std::optional<std::string> exchange(const std::string& request) {
    write(request);
    wait(std::chrono::milliseconds(1));
    const Bytes reply = read();
    if (reply.empty()) return std::nullopt;
    return std::string(reply.begin(), reply.end());
  }
  [[nodiscard]] int packets() const { return packets_; }

 private:
  VirtualClock clock_;
  SimEnumerator buses_{clock_};
  FalconArmModel* arm_{nullptr};
  std::unique_ptr<bus::UsbDevice> device_;
  int packets_{0};
};

}  // namespace thimble::sim
