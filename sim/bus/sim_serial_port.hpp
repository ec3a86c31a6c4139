#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/plugin/sim_serial_model.hpp"
#include "hal/rt/annotations.hpp"
#include "sim/bus/host_slot.hpp"
#include "sim/bus/sim_port.hpp"
#include "sim/bus/sim_serial.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::sim {

// The plug of one simulated serial device: runs its line for as long as it exists.
//
// Every kUsbRound, counted from construction, it brings the model to the round's time and then,
// while plugged and opened, carries bytes: first to the device, of the message that is under way,
// then from it, stamped with the round's time. How many: of CDC-ACM one packet of 64 bytes out and
// then what packets fit into the round of a full-speed bus (SimUsbPort has the figures); of a line
// with a rate what it carries each way in 10 bits a byte, to the byte over any time. Bytes that the
// device has no room for wait. A line opened at another rate than the device's carries nothing:
// what would arrive is no byte of anybody's. While unplugged the model goes on without its line;
// where its supply went with the cable, its power is cut at both ends of that time.
//
// Thread: construction and destruction while nobody runs the clock; fire() from the thread
// that runs it; everything else from one control thread, which may be another.
// RT: a round is as bounded as the model; it allocates nothing and takes no lock.
// Ownership: owns the model; the clock must outlive it, and it must outlive its SimSerial.
class SimSerialPort final : public SimPort, private Event {
 public:
  SimSerialPort(VirtualClock& clock, bus::DeviceAddress address,
                std::unique_ptr<plugin::SimSerialModel> model);

  [[nodiscard]] Result<std::unique_ptr<bus::SerialPort>> open_serial(
      const bus::SerialLine& line) override;
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override {
    return model_->arm_backend();
  }
  // After it returns no round touches `host`. Waits at most for the round under way.
  void detach(SimSerial& host) noexcept { host_.detach(host); }

 private:
  // What one direction of a line with a rate may still carry, in bits times 1e9.
  class Credit {
   public:
    THIMBLE_RT void earn(std::uint32_t bit_per_s) noexcept;
    [[nodiscard]] std::size_t bytes() const noexcept;
    THIMBLE_RT void spend(std::size_t bytes) noexcept;

   private:
    std::int64_t nanobits_{0};
  };

  THIMBLE_RT void fire(MonotonicTime now) noexcept override;
  void drop_host() noexcept override;
  THIMBLE_RT void serve(SimSerial& host, MonotonicTime now) noexcept;
  THIMBLE_RT void serve_packets(SimSerial& host, MonotonicTime now) noexcept;
  THIMBLE_RT void serve_line(SimSerial& host, MonotonicTime now) noexcept;
  // At most `room` bytes each; how many it were.
  THIMBLE_RT std::size_t send(SimSerial& host, std::size_t room) noexcept;
  THIMBLE_RT std::size_t fetch(SimSerial& host, std::size_t room, MonotonicTime now) noexcept;

  VirtualClock* clock_;
  std::unique_ptr<plugin::SimSerialModel> model_;
  std::uint32_t bit_per_s_;
  Credit out_credit_;
  Credit in_credit_;
  std::array<std::uint8_t, bus::kMaxSerialBytes> buffer_{};
  std::atomic<bool> is_in_tune_{true};  // the line is set as the device's
  HostSlot<SimSerial> host_;
};

}  // namespace thimble::sim
