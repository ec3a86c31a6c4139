#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "hal/base/time.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/linux/background_worker.hpp"
#include "hal/linux/hid_address.hpp"

namespace thimble::linux {

// A device that is plugged into this machine.
struct FoundDevice {
  bus::BusDeviceInfo info;
  std::string node;      // "/dev/hidraw0", "/dev/bus/usb/001/004"
  std::string hiddev;    // of a HID device, "/dev/usb/hiddev0"; empty: none
  std::string identity;  // another one after it was plugged in anew
};

// What was read of one; an address of HID needs those of all.
struct ReadDevice {
  FoundDevice device;
  std::optional<DevicePlace> place;
};

// Readings of devices, each in a thread beside the caller's, since the kernel may hold one up for
// as long as a device does not answer it: one that is late is left to itself, and its device counts
// as it was read last, or as not there, until it ends. It holds up no other device's reading, but
// where kMostLeft threads are left so, nothing is read until one of them ends
// (docs/decisions/0407-devices-that-hang-take-eight-threads.md).
//
// Thread: one; a reading runs in another and owns all that it uses. Not RT.
// Ownership: its end waits for nobody. Errors: a reading gives nothing for what is no device, and
// so does one that throws; where no thread can be had, it counts as late.
class DeviceReadings {
 public:
  using Read = std::function<std::optional<ReadDevice>()>;
  // Ours: an eighth of what the unit grants the process (TasksMax in systemd/thimbled.service).
  static constexpr std::size_t kMostLeft = 8;

  // Waits `patience` at most, and not at all for one that is late already.
  [[nodiscard]] std::optional<ReadDevice> get(const std::string& identity, Read read,
                                              Duration patience);
  // What is not among `identities` is gone for good.
  void keep(const std::set<std::string>& identities);
  // Readings that have not ended.
  [[nodiscard]] std::size_t late() const noexcept { return late_.size(); }
  // Devices that were not read, as there was no thread left for them.
  [[nodiscard]] std::size_t put_off() const noexcept { return put_off_.size(); }
  // Whether one that was late has ended, and nobody asked for it since, or one that was put off can
  // be read now.
  [[nodiscard]] bool has_caught_up() const noexcept;

 private:
  struct Slot {
    std::atomic<bool> is_done{false};
    std::optional<ReadDevice> value;
  };
  bool has_worker() noexcept;
  [[nodiscard]] bool is_crowded() const noexcept;
  std::optional<ReadDevice> remember(const std::string& identity, const Slot& slot);
  std::optional<ReadDevice> last(const std::string& identity) const;

  std::map<std::string, ReadDevice> last_;
  std::map<std::string, std::shared_ptr<Slot>> late_;
  std::set<std::string> put_off_;
  std::vector<std::shared_ptr<const Slot>>
      left_;                                  // each has a thread, also where its device is gone
  std::unique_ptr<BackgroundWorker> worker_;  // nullptr: it is left with who is late
};

}  // namespace thimble::linux
