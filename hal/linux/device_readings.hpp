#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "hal/base/time.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/linux/background_worker.hpp"
#include "hal/linux/hid_address.hpp"
#include "hal/linux/sysfs_places.hpp"

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
// as it was read last, or as not there, until it ends. It holds up no other device's reading. Of a
// device with kMostLeftOfOne such places no further one is read until one of them ends
// (docs/decisions/0498-a-device-that-hangs-takes-two-threads.md), and where kMostLeft threads are
// left so, nothing is (0407-devices-that-hang-take-eight-threads.md).
//
// Thread: one; a reading runs in another and owns all that it uses. Not RT.
// Ownership: its end waits for nobody. Errors: a reading gives nothing for what is no device, and
// so does one that throws; where no thread can be had, it is put off.
class DeviceReadings {
 public:
  using Read = std::function<std::optional<ReadDevice>()>;
  // Ours: an eighth of what the unit grants the process (TasksMax in systemd/thimbled.service).
  static constexpr std::size_t kMostLeft = 8;
  // Ours: of one device, those that are gone from its port among them. An arm has two places, the
  // device itself and one interface.
  static constexpr std::size_t kMostLeftOfOne = 2;

  // Waits `patience` at most, and not at all for one that is late already.
  [[nodiscard]] std::optional<ReadDevice> get(const SysfsPlace& place, Read read,
                                              Duration patience);
  // What is not among `identities` is gone for good.
  void keep(const std::set<std::string>& identities);
  // Readings that have not ended.
  [[nodiscard]] std::size_t late() const noexcept { return late_.size(); }
  // Places that were not read, as there was no thread left for them.
  [[nodiscard]] std::size_t put_off() const noexcept { return put_off_.size(); }
  // Whether one that was late has ended, and nobody asked for it since, or one that was put off can
  // be read now.
  [[nodiscard]] bool has_caught_up() const noexcept;

 private:
  struct Slot {
    explicit Slot(std::string where) : device(std::move(where)) {}
    const std::string device;
    std::atomic<bool> is_done{false};
    std::optional<ReadDevice> value;
  };
  bool has_worker() noexcept;
  // Whether no thread is left for a place of `device`.
  [[nodiscard]] bool is_crowded(const std::string& device) const noexcept;
  std::optional<ReadDevice> remember(const std::string& identity, const Slot& slot);
  std::optional<ReadDevice> last(const std::string& identity) const;

  std::map<std::string, ReadDevice> last_;
  std::map<std::string, std::shared_ptr<Slot>> late_;
  std::map<std::string, std::string> put_off_;  // devices by identity
  std::vector<std::shared_ptr<const Slot>>
      left_;                                  // each has a thread, also where its device is gone
  std::unique_ptr<BackgroundWorker> worker_;  // nullptr: it is left with who is late
};

}  // namespace thimble::linux
