#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hal/linux/descriptor.hpp"
#include "hal/plugin/sim_model.hpp"
#include "sim/export/plug.hpp"
#include "sim/export/uhid_wire.hpp"
#include "sim/time/event_queue.hpp"

namespace thimble::sim {

// Offers a simulated HID device to the kernel through /dev/uhid.
//
// Runs the device's frames on the model's clock, as SimHidPort does: advance, what the host sent,
// what the device sends. Requests to the control pipe are answered in the frame that finds them.
// The kernel's uhid has no endpoints, so two things are made up here (decision 0296): of several
// output reports in one frame the newest counts, for nothing holds up who writes them; and a report
// that nobody has the device open for waits in its endpoint, as it does on a wire.
//
// Thread, Errors: as Plug. RT: none of it.
// Ownership: has the node; model and surroundings must outlive it. Ends unplugged, for the kernel
// sees the node close.
class UhidPlug final : public Plug, private Event {
 public:
  // `node`: /dev/uhid, or in tests one end of a socket pair that keeps messages apart;
  // non-blocking. `info`: how the device is called; else as the model describes itself.
  UhidPlug(linux::Descriptor node, plugin::SimHidModel& model, bus::BusDeviceInfo info,
           const PlugSurroundings& surroundings);

  Result<void> plug() override;
  Result<void> unplug(Supply supply) override;
  [[nodiscard]] bool is_plugged() const noexcept override { return is_plugged_; }
  [[nodiscard]] bool is_open() const noexcept override { return is_plugged_ && is_open_; }
  [[nodiscard]] bool is_broken() const noexcept override { return is_broken_; }
  [[nodiscard]] bool has_endpoints() const noexcept override { return false; }
  [[nodiscard]] PlugCounters counters() const noexcept override { return counters_; }
  // A frame: each is needed, and what the kernel says waits for the next one.
  [[nodiscard]] Duration round_period() const noexcept override { return model_->frame_period(); }
  [[nodiscard]] MonotonicTime next_needed() const noexcept override {
    return around_.clock->now() + round_period();
  }
  [[nodiscard]] bool wait_for_kernel(MonotonicTime) noexcept override { return false; }
  void advance_model(MonotonicTime t) noexcept override { model_->advance(t); }
  void leave_out_until(MonotonicTime) noexcept override {}

 private:
  void fire(MonotonicTime now) noexcept override;
  void take_events(MonotonicTime now);
  [[nodiscard]] bool read_event();  // into event_; false: there is none
  void take(const uhid::Event& event, MonotonicTime now);
  void note_output(const uhid::Output& output);
  void answer(const uhid::GetReport& request, MonotonicTime now);
  void answer(const uhid::SetReport& request, MonotonicTime now);
  void give_output(MonotonicTime now);
  void send_input(MonotonicTime now);
  bool write_event(std::span<const std::uint8_t> bytes);
  // Without the zero in front, which the kernel puts where reports have no numbers.
  [[nodiscard]] std::span<const std::uint8_t> without_number(
      std::span<const std::uint8_t> bytes) const noexcept;

  linux::Descriptor node_;
  plugin::SimHidModel* model_;
  bus::BusDeviceInfo info_;
  std::vector<std::uint8_t> descriptor_;
  PlugSurroundings around_;
  bool is_plugged_{false};
  bool has_no_supply_{true};  // it comes with the plug
  bool is_open_{false};
  bool is_broken_{false};
  PlugCounters counters_{};
  std::array<std::uint8_t, uhid::kEventBytes> event_{};
  // The newest that was not given to the model yet.
  std::array<std::uint8_t, uhid::kMaxReportBytes> output_{};
  std::size_t output_bytes_{0};
  bool has_output_{false};
  std::array<std::uint8_t, bus::kMaxHidReportBytes> endpoint_{};  // what waits for the host
  std::size_t endpoint_bytes_{0};
};

}  // namespace thimble::sim
