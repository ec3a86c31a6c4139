#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "hal/plugin/sim_model.hpp"
#include "hal/plugin/sim_usb_model.hpp"
#include "sim/bus/sim_memory_window.hpp"
#include "sim/model/cam/board_page.hpp"
#include "sim/model/cam/usb_frames.hpp"

namespace thimble::sim::cam {

struct CamUsbCounters {
  std::uint64_t carried_out{0};
  std::uint64_t begins{0};
  std::uint64_t malformed{0};
  std::uint64_t out_of_order{0};
  std::uint64_t refused{0};  // out of range, or not aligned
  std::uint64_t put_off{0};  // packets: NAK, as too many replies waited
  bool operator==(const CamUsbCounters&) const = default;
};

// A board on USB: its page and window behind two bulk pipes (docs/cambus.md, section 7).
//
// Time: a request is carried out when its last packet has come, on the board as it is then.
// Exact: frames, order, flow. Left out: how long the board's own processor takes.
// Thread: one. Not RT, other than other models: a scan is done in it and it allocates, so its bus
// is run by the thread of a world (SimUsbCamBoard), never by that of an arm.
class CamUsbModel final : public plugin::SimUsbModel, public plugin::ModelPanel {
 public:
  explicit CamUsbModel(const BoardOptions& options,
                       std::size_t packet_bytes = cambus::usb::kFullSpeedPacketBytes);

  [[nodiscard]] bus::BusDeviceInfo describe() const override;
  void advance(MonotonicTime t) noexcept override;
  plugin::UsbAnswer control(const bus::UsbControlRequest& request,
                            std::span<std::uint8_t> in) noexcept override;
  plugin::UsbHandshake out_packet(std::uint8_t endpoint,
                                  std::span<const std::uint8_t> bytes) noexcept override;
  plugin::UsbAnswer in_packet(std::uint8_t endpoint, std::span<std::uint8_t> out) noexcept override;
  // Nothing comes from it unasked.
  [[nodiscard]] MonotonicTime unchanged_until() const noexcept override;
  // Another incarnation, with nothing in its memory.
  void power_cycle() noexcept override;
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override { return nullptr; }
  [[nodiscard]] plugin::ModelPanel* panel() noexcept override { return this; }

  // Of what nobody presses: what its machine has counted since it has power.
  bool press(unsigned /*number*/, bool /*pressed*/) noexcept override { return false; }
  [[nodiscard]] std::vector<Reading> readings() const override;

  // It answers, but its machine does nothing any more, nor does its beat.
  void freeze() noexcept { is_frozen_ = true; }
  [[nodiscard]] const CamUsbCounters& counters() const noexcept { return counters_; }
  // What is behind the plug, while it has power: from the first advance() on.
  [[nodiscard]] BoardPage& board() noexcept { return *board_; }

 private:
  void take(std::span<const std::uint8_t> transfer);
  [[nodiscard]] bool is_in_order(const UsbRequest& request) noexcept;
  [[nodiscard]] cambus::usb::Status check(const UsbRequest& request) const noexcept;
  void carry_out(const UsbRequest& request);
  void serve();
  void answer(const UsbRequest& request, cambus::usb::Status status,
              std::span<const std::uint32_t> payload = {});

  BoardOptions options_;
  std::size_t packet_bytes_;
  MonotonicTime now_{};
  SimMemory memory_;
  std::optional<BoardPage> board_;  // while it has power
  bool is_frozen_{false};
  PacketCollector requests_;
  PacketFeeder replies_;
  std::optional<std::uint16_t> next_number_;  // nothing: the host has to begin
  CamUsbCounters counters_;
};

}  // namespace thimble::sim::cam
