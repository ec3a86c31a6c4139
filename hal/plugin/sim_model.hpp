#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/plugin/arm_backend.hpp"
#include "hal/plugin/sim_serial_model.hpp"
#include "hal/plugin/sim_usb_model.hpp"

namespace thimble::plugin {

// What a person can press and read of a simulated device that is no arm, or beside an arm's verbs.
// Thread: that of the bus. Ownership: a face of the model; valid as long as that is. RT: press()
// and set_fault(), bounded; the rest is not.
class ModelPanel {
 public:
  struct Reading {
    std::string name;  // with its unit, as in "line_4" or "latency_s"
    double value{0};
  };
  struct Fault {
    std::string_view name;    // of the program's text
    std::uint32_t number{0};  // 0: it does not do that; what another means is the model's to say
  };
  virtual ~ModelPanel() = default;
  // False: it has no such button, switch or input.
  virtual bool press(unsigned number, bool pressed) noexcept = 0;
  // What its firmware does wrong on demand, by names of its own, until it is set to 0 or, of what
  // happens once, has happened; a loss of power ends none. False: it has no such fault, or not that
  // number.
  virtual bool set_fault(std::string_view /*name*/, std::uint32_t /*number*/) noexcept {
    return false;
  }
  // All that it has, as they stand.
  [[nodiscard]] virtual std::vector<Fault> faults() const { return {}; }
  [[nodiscard]] virtual std::vector<Reading> readings() const = 0;
};

enum class HidReportKind : std::uint8_t { Input, Output, Feature };

// Bus face of a simulated HID device: what its firmware and USB interface do.
// The bus calls, in virtual time and from one thread, once per frame: advance(t), then
// out_report() if the host had one queued before the frame began, then in_report(). Requests to the
// control pipe come between frames, from a kernel that it is offered to (sim/export); no driver
// here makes any.
//
// Thread: that of the bus. RT: all but describe() and report_descriptor(): bounded, no allocation.
// Ownership: of the bus. Errors: what a device can say; bytes come from a driver and may be any.
class SimHidModel {
 public:
  virtual ~SimHidModel() = default;
  [[nodiscard]] virtual bus::BusDeviceInfo describe() const = 0;
  [[nodiscard]] virtual Duration frame_period() const noexcept = 0;  // 1 ms at full speed
  // Brings mechanics and firmware to `t` (never backwards).
  virtual void advance(MonotonicTime t) noexcept = 0;
  virtual void out_report(std::span<const std::uint8_t> bytes) noexcept = 0;
  // Fills `out` (at most kMaxHidReportBytes) and returns its length; 0: the device NAKs.
  virtual std::size_t in_report(std::span<std::uint8_t> out) noexcept = 0;
  // Its HID report descriptor (HID 1.11, 6.2.2). Unless a model has its own: plain bytes of the
  // lengths that describe() tells. Not RT.
  [[nodiscard]] virtual std::vector<std::uint8_t> report_descriptor() const;
  // GET_REPORT and SET_REPORT (HID 1.11, 7.2): the first byte is the report's number, if the device
  // numbers its reports (`number` is 0 else). get: fills `out` and returns the length, 0: refused.
  // set: false: refused.
  virtual std::size_t get_report(HidReportKind, std::uint8_t /*number*/,
                                 std::span<std::uint8_t> /*out*/) noexcept {
    return 0;
  }
  virtual bool set_report(HidReportKind, std::span<const std::uint8_t> /*bytes*/) noexcept {
    return false;
  }
  // Power cut and restored, as on unplug and replug: counters and state are lost.
  virtual void power_cycle() noexcept = 0;
  [[nodiscard]] virtual ArmBackend* arm_backend() noexcept = 0;  // nullptr: not an arm
  [[nodiscard]] virtual ModelPanel* panel() noexcept { return nullptr; }
};

struct SimModelSettings {
  double amplifier_max_a{0};  // full scale the firmware was built with; 0: the model's own
  std::uint64_t seed{0};
};

// A simulated device of any bus, as "sim:NAME" makes it. Never without a model.
using SimModel = std::variant<std::unique_ptr<SimHidModel>, std::unique_ptr<SimUsbModel>,
                              std::unique_ptr<SimSerialModel>>;
// What the model says of itself, with the kind of its bus. Not RT.
[[nodiscard]] bus::BusDeviceInfo describe(const SimModel& model);
[[nodiscard]] ArmBackend* arm_backend(const SimModel& model) noexcept;

// How a model registers, as a driver does: "sim:NAME" makes one. It has one of the creators:
// that says on which bus it is.
struct SimModelEntry {
  std::string name;
  std::string description;
  std::function<Result<std::unique_ptr<SimHidModel>>(const SimModelSettings&)> create_hid{};
  std::function<Result<std::unique_ptr<SimUsbModel>>(const SimModelSettings&)> create_usb{};
  std::function<Result<std::unique_ptr<SimSerialModel>>(const SimModelSettings&)> create_serial{};

  // On whichever bus it is. Not RT. Errors: the creator's; InvalidArgument when it has none.
  [[nodiscard]] Result<SimModel> create(const SimModelSettings& settings) const;
};

class SimModelRegistry {
 public:
  void add(SimModelEntry entry) { entries_.push_back(std::move(entry)); }
  [[nodiscard]] const std::vector<SimModelEntry>& entries() const noexcept { return entries_; }
  [[nodiscard]] const SimModelEntry* find(std::string_view name) const noexcept {
    for (const SimModelEntry& entry : entries_) {
      if (entry.name == name) return &entry;
    }
    return nullptr;
  }

 private:
  std::vector<SimModelEntry> entries_;
};

}  // namespace thimble::plugin
