#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <utility>

#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/plugin/sim_model.hpp"
#include "hal/rt/annotations.hpp"
#include "sim/bus/supply.hpp"

namespace thimble::sim {

// The plug of one simulated device, of whatever kind: what SimEnumerator knows of it.
//
// Thread: generation() from any; the rest from one control thread.
class SimPort {
 public:
  // `model`: what the device says of itself; where it hangs is the bus's to say.
  SimPort(bus::BusDeviceInfo model, bus::DeviceAddress address, bus::BusKind kind) noexcept;
  SimPort(const SimPort&) = delete;
  SimPort& operator=(const SimPort&) = delete;
  virtual ~SimPort() = default;

  [[nodiscard]] const bus::BusDeviceInfo& info() const noexcept { return info_; }
  [[nodiscard]] bool is_plugged() const noexcept { return generation() % 2 != 0; }
  // Both return false when there was nothing to do. An open device is Disconnected from then on.
  // unplug(Supply::Goes) of one whose cable alone was pulled takes its supply, too.
  bool unplug(Supply supply = Supply::Goes) noexcept;
  bool replug() noexcept;
  // +1 at every unplug and replug: odd while plugged.
  THIMBLE_RT [[nodiscard]] std::uint64_t generation() const noexcept {
    return state_.load(std::memory_order_acquire) % kOneCut;
  }

  // NotFound while unplugged; Busy while an earlier device of this plugging is open;
  // InvalidArgument for a device of another kind, or a claim or line that it does not fill.
  [[nodiscard]] virtual Result<std::unique_ptr<bus::HidDevice>> open_hid();
  [[nodiscard]] virtual Result<std::unique_ptr<bus::UsbDevice>> open_usb(
      const bus::UsbClaim& claim);
  [[nodiscard]] virtual Result<std::unique_ptr<bus::SerialPort>> open_serial(
      const bus::SerialLine& line);
  [[nodiscard]] virtual plugin::ArmBackend* arm_backend() noexcept = 0;

 protected:
  // Why this device cannot be opened now, whatever its kind.
  [[nodiscard]] Result<void> check_free(bool is_taken) const;
  // Brings the model to `now`; if its supply went with the plug since the last time, its power was
  // gone. True while it is plugged. Thread: that of the clock.
  template <class Model>
  THIMBLE_RT bool advance(Model& model, MonotonicTime now) noexcept {
    const std::uint64_t state = state_.load(std::memory_order_acquire);
    const std::uint64_t cuts = state / kOneCut;
    if (std::exchange(known_cuts_, cuts) != cuts) model.power_cycle();
    model.advance(now);
    return state % 2 != 0;
  }

 private:
  virtual void drop_host() noexcept = 0;  // the cable is pulled

  bus::BusDeviceInfo info_;
  static constexpr std::uint64_t kOneCut = std::uint64_t{1} << 32;

  // One word, so that nobody sees a plug without what became of the supply: generation() below
  // kOneCut, above it +1 at both ends of a time without supply.
  std::atomic<std::uint64_t> state_{1};
  std::uint64_t known_cuts_{0};  // clock thread: those that the model knows of
  Supply supply_{Supply::Goes};  // control thread: what the last unplug() left
};

}  // namespace thimble::sim
