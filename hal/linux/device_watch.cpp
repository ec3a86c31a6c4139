#include "hal/linux/device_watch.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

#include "hal/base/contain.hpp"

namespace thimble::linux {

using bus::BusEvent;

bool is_among(const FoundDevice& wanted, const std::vector<FoundDevice>& devices) {
  return std::any_of(devices.begin(), devices.end(), [&](const FoundDevice& device) {
    return device.identity == wanted.identity && device.info == wanted.info;
  });
}

DeviceWatch::DeviceWatch(std::shared_ptr<UdevScan> scan)
    : scan_(std::move(scan)), known_(scan_->devices()) {}

DeviceWatch::~DeviceWatch() {
  if (look_ != nullptr) worker_->finish();
}

std::optional<BusEvent> DeviceWatch::poll() {
  if (events_.empty()) follow(Duration(0));
  if (events_.empty()) return std::nullopt;
  BusEvent event = std::move(events_.front());
  events_.pop_front();
  return event;
}

void DeviceWatch::catch_up(Duration patience) {
  follow(patience);
  // What was said during a look may be later than what it saw.
  if (look_ == nullptr) follow(patience);
}

void DeviceWatch::follow(Duration patience) {
  if (look_ == nullptr) {
    has_news_ = scan_->has_news() || has_news_;
    if (!has_news_ || !begin_look()) return;
    has_news_ = false;
  }
  if (!worker_->wait(patience)) return;
  Result<Found> found = std::move(*std::exchange(look_, nullptr));
  if (found) {
    note_changes(*std::move(found));
  } else {
    has_news_ = true;
  }
}

bool DeviceWatch::begin_look() {
  try {
    if (worker_ == nullptr) worker_ = std::make_unique<BackgroundWorker>();
  } catch (const std::system_error&) {
    return false;  // too many threads
  }
  look_ = std::make_shared<Result<Found>>();
  worker_->post([look = look_, scan = scan_] { *look = contain([&] { return scan->devices(); }); });
  return true;
}

void DeviceWatch::note_changes(Found now) {
  for (const FoundDevice& device : known_) {
    if (!is_among(device, now)) events_.push_back({BusEvent::Kind::Left, device.info});
  }
  for (const FoundDevice& device : now) {
    if (!is_among(device, known_)) events_.push_back({BusEvent::Kind::Arrived, device.info});
  }
  known_ = std::move(now);
}

}  // namespace thimble::linux
