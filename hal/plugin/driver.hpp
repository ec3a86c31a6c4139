#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/device/haptic_device.hpp"

namespace thimble::plugin {

// What the configuration says about one arm, as far as a driver needs it.
struct DriverSettings {
  std::string model;                      // "" = the driver's choice for the ids, if it has one
  std::optional<double> amplifier_max_a;  // full scale of the amplifier; hardware does not tell
  bool is_named_by_person{false};  // the configuration names this very device (serial or port)
  std::string firmware;            // file for an arm that forgets its own; "" = none
  std::string firmware_sha256;     // of that file, hexadecimal; "" = whatever the driver knows
  // Measured force of an arm that is told counts, of each motor alike:
  // drivers/falcon/falcon_model.hpp says where and along what.
  std::optional<double> newton_per_count;
  // That of the servo and of the bus, for a device whose state goes on while it says nothing; it
  // must outlive the device. nullptr: open() of a driver that needs one gives InvalidArgument, or a
  // device that does without, as the driver says.
  const Clock* clock{nullptr};
};

// Which of those a driver makes something of.
struct UsedSettings {
  bool amplifier_max_a{false};
  bool firmware{false};  // and its sum
  bool newton_per_count{false};
};

// Finds and opens devices of one family.
//
// Thread: any but a real-time one; for several devices at once, so a driver has no state but
// theirs. Contract of probe(): passive: it sees descriptors, never a byte of traffic. NotMine lets
// the next driver try, and says nothing of a device whose ids are not this family's: what it says
// of one whose ids are is told if no driver takes it. Any other error stops matching and is
// reported.
class Driver {
 public:
  virtual ~Driver() = default;
  [[nodiscard]] virtual std::string_view name() const noexcept = 0;
  // What DriverSettings::model may say of its devices; nothing: it cannot tell.
  [[nodiscard]] virtual std::vector<std::string> models() const = 0;
  // On which buses it drives that model, or any of its own where it is empty; an empty list: it has
  // no such model. Nothing: it cannot tell.
  [[nodiscard]] virtual std::optional<std::vector<bus::BusKind>> buses_of(
      std::string_view /*model*/) const {
    return std::nullopt;
  }
  // Nothing: it cannot tell.
  [[nodiscard]] virtual std::optional<UsedSettings> used_settings() const { return std::nullopt; }
  // What open() would find wrong with the files that `settings` name; touches no device.
  [[nodiscard]] virtual Result<void> check_files(const DriverSettings& settings) const = 0;
  [[nodiscard]] virtual Result<void> probe(const bus::BusDeviceInfo& info,
                                           const DriverSettings& settings) const = 0;
  // Opens through `buses` and returns a device that has sent nothing yet. Waits for the kernel as
  // BusEnumerator::open_*() does, and for no answer of the device. Errors: those, and
  // InvalidArgument or Unsupported for what `settings` say or the device is.
  [[nodiscard]] virtual Result<std::unique_ptr<HapticDevice>> open(
      bus::BusEnumerator& buses, const bus::BusDeviceInfo& info,
      const DriverSettings& settings) const = 0;
};

}  // namespace thimble::plugin
