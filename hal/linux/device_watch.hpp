#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "hal/base/time.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/linux/background_worker.hpp"
#include "hal/linux/udev_scan.hpp"

namespace thimble::linux {

// What came and went, found by looking again when udevd says that something has: a device that left
// and returned between two looks is told of as Left, then Arrived. A look waits for the kernel, and
// so has a thread of its own.
//
// Thread: one. Not RT. Ownership: its end waits for a look under way. Errors: none; where no thread
// can be had, or a look throws, nothing is told until one can or does not.
class DeviceWatch {
 public:
  // What is there now is not told of.
  explicit DeviceWatch(std::shared_ptr<UdevScan> scan);

  ~DeviceWatch();
  DeviceWatch(const DeviceWatch&) = delete;
  DeviceWatch& operator=(const DeviceWatch&) = delete;

  // The next one, in order. Never waits: news are told once they have been looked at.
  [[nodiscard]] std::optional<bus::BusEvent> poll();
  // Until poll() knows of all that udevd has said, `patience` at most; for who may wait.
  void catch_up(Duration patience);

 private:
  using Found = std::vector<FoundDevice>;
  void follow(Duration patience);
  [[nodiscard]] bool begin_look();
  void note_changes(Found now);

  std::shared_ptr<UdevScan> scan_;
  Found known_;           // what poll() has told of
  bool has_news_{false};  // that no look has begun to look at
  std::deque<bus::BusEvent> events_;
  // Under way; nullptr: none. What is found; an error: it threw.
  std::shared_ptr<Result<Found>> look_;
  std::unique_ptr<BackgroundWorker> worker_;
};

// The same device, under the same address, and described alike.
[[nodiscard]] bool is_among(const FoundDevice& wanted, const std::vector<FoundDevice>& devices);

}  // namespace thimble::linux
