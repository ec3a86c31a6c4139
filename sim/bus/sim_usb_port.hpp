#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/plugin/sim_usb_model.hpp"
#include "hal/rt/annotations.hpp"
#include "sim/bus/host_slot.hpp"
#include "sim/bus/sim_port.hpp"
#include "sim/bus/sim_usb.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::sim {

// USB 2.0, 5.3.3: a full-speed frame.
inline constexpr Duration kUsbFrame = std::chrono::milliseconds(1);
// Ours: how often in a frame the host controller comes round. 125 us lies between what was measured
// on an idle full-speed bus for a bulk packet out (84 us) and in (167 us).
inline constexpr unsigned kUsbRoundsPerFrame = 8;
inline constexpr Duration kUsbRound = kUsbFrame / kUsbRoundsPerFrame;
// 12 Mbit/s for one round.
inline constexpr std::size_t kUsbBytesPerRound = 1500 / kUsbRoundsPerFrame;
// USB 2.0, tables 5-4, 5-7 and 5-9: tokens, handshakes and gaps of one transfer beside its payload,
// at full speed; that of control contains the setup packet.
inline constexpr std::size_t kUsbControlOverheadBytes = 45;
inline constexpr std::size_t kUsbPacketOverheadBytes = 13;

// The plug of one simulated full-speed USB device: runs its bus for as long as it exists.
//
// Eight times in a frame, counted from construction, it brings the model to the round's time. While
// plugged and opened it then does, as far as the bytes of the round reach: a control request; one
// packet to each OUT pipe that has one; then in turn more to each OUT pipe that is a queue and has
// been taken from, and from the IN pipes, until all say Nak.
// What was submitted before a round began is taken in it, and what comes in is stamped with its
// time. Bulk pipes take part in every round, interrupt pipes in the one that ends every
// `interval`th frame, and those first. Bytes that a round did not need are gone; what did not fit
// has to wait. While unplugged the model goes on without its bus; where its supply went with the
// cable, its power is cut at both ends of that time.
//
// Thread: construction and destruction while nobody runs the clock; fire() from the thread
// that runs it; everything else from one control thread, which may be another.
// RT: a round is as bounded as the model; it allocates nothing and takes no lock.
// Ownership: owns the model; the clock must outlive it, and it must outlive its SimUsb.
class SimUsbPort final : public SimPort, private Event {
 public:
  SimUsbPort(VirtualClock& clock, bus::DeviceAddress address,
             std::unique_ptr<plugin::SimUsbModel> model);

  [[nodiscard]] Result<std::unique_ptr<bus::UsbDevice>> open_usb(
      const bus::UsbClaim& claim) override;
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override {
    return model_->arm_backend();
  }
  // After it returns no round touches `host`. Waits at most for the round under way.
  void detach(SimUsb& host) noexcept { host_.detach(host); }

 private:
  THIMBLE_RT void fire(MonotonicTime now) noexcept override;
  void drop_host() noexcept override;

  THIMBLE_RT void serve(SimUsb& host, MonotonicTime now) noexcept;
  THIMBLE_RT void serve_control(SimUsb& host) noexcept;
  THIMBLE_RT void serve_kind(SimUsb& host, bus::UsbTransferKind kind, MonotonicTime now) noexcept;
  // Each: false when the pipe has nothing more for this round.
  THIMBLE_RT bool send_packet(SimUsb& host, std::size_t pipe) noexcept;
  THIMBLE_RT bool fetch_packet(SimUsb& host, std::size_t pipe, MonotonicTime now) noexcept;
  [[nodiscard]] bool is_due(const bus::UsbEndpointInfo& endpoint) const noexcept;
  // False when the round has not that many bytes left.
  THIMBLE_RT bool take_budget(std::size_t bytes) noexcept;

  VirtualClock* clock_;
  std::unique_ptr<plugin::SimUsbModel> model_;
  std::uint64_t round_{0};  // since construction; every eighth ends a frame
  std::size_t bytes_left_{0};
  std::array<std::uint8_t, bus::kMaxUsbPacketBytes> buffer_{};
  HostSlot<SimUsb> host_;
};

}  // namespace thimble::sim
