#include "hal/linux/device_readings.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

#include "hal/base/contain.hpp"

namespace thimble::linux {

std::optional<ReadDevice> DeviceReadings::get(const SysfsPlace& place, Read read,
                                              Duration patience) {
  const std::string& identity = place.identity;
  const auto late = late_.find(identity);
  if (late != late_.end()) {
    if (!late->second->is_done.load()) return last(identity);
    const std::shared_ptr<Slot> slot = late->second;
    late_.erase(late);
    return remember(identity, *slot);
  }
  if (is_crowded(place.device) || !has_worker()) {
    put_off_.insert_or_assign(identity, place.device);
    return last(identity);
  }
  put_off_.erase(identity);
  const auto slot = std::make_shared<Slot>(place.device);
  worker_->post([slot, read = std::move(read)] {
    slot->value = contain(read).value_or(std::nullopt);
    slot->is_done.store(true);
  });
  if (worker_->wait(patience)) return remember(identity, *slot);
  late_.emplace(identity, slot);
  std::erase_if(left_, [](const auto& one) { return one->is_done.load(); });
  left_.push_back(slot);
  worker_.reset();
  return last(identity);
}

bool DeviceReadings::has_worker() noexcept {
  try {
    if (worker_ == nullptr) worker_ = std::make_unique<BackgroundWorker>();
  } catch (const std::system_error&) {
    return false;  // too many threads
  }
  return true;
}

bool DeviceReadings::is_crowded(const std::string& device) const noexcept {
  std::size_t hanging = 0;
  std::size_t of_this_one = 0;
  for (const auto& slot : left_) {
    if (slot->is_done.load()) continue;
    ++hanging;
    if (slot->device == device) ++of_this_one;
  }
  return hanging >= kMostLeft || of_this_one >= kMostLeftOfOne;
}

void DeviceReadings::keep(const std::set<std::string>& identities) {
  const auto is_gone = [&](const auto& entry) { return !identities.contains(entry.first); };
  std::erase_if(last_, is_gone);
  std::erase_if(late_, is_gone);
  std::erase_if(put_off_, is_gone);
}

bool DeviceReadings::has_caught_up() const noexcept {
  const auto can_be_read = [this](const auto& entry) { return !is_crowded(entry.second); };
  if (std::any_of(put_off_.begin(), put_off_.end(), can_be_read)) return true;
  return std::any_of(late_.begin(), late_.end(),
                     [](const auto& entry) { return entry.second->is_done.load(); });
}

std::optional<ReadDevice> DeviceReadings::remember(const std::string& identity, const Slot& slot) {
  if (slot.value) {
    last_.insert_or_assign(identity, *slot.value);
  } else {
    last_.erase(identity);
  }
  return slot.value;
}

std::optional<ReadDevice> DeviceReadings::last(const std::string& identity) const {
  const auto found = last_.find(identity);
  if (found == last_.end()) return std::nullopt;
  return found->second;
}

}  // namespace thimble::linux
