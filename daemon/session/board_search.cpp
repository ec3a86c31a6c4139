#include "daemon/session/board_search.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace thimble::session {
namespace {

// Ends where devices may last: the kernel holds up who closes one.
class ReturnedDevice final : public bus::UsbDevice {
 public:
  ReturnedDevice(std::unique_ptr<bus::UsbDevice> device, devices::DeviceExecutor& executor)
      : device_(std::move(device)), executor_(executor) {}
  ~ReturnedDevice() override {
    executor_.post([device = std::move(device_)]() mutable { device.reset(); });
  }
  ReturnedDevice(const ReturnedDevice&) = delete;
  ReturnedDevice& operator=(const ReturnedDevice&) = delete;

  IoStatus read(std::uint8_t endpoint, bus::UsbPacket& out) noexcept override {
    return device_->read(endpoint, out);
  }
  IoStatus submit(std::uint8_t endpoint, std::span<const std::uint8_t> packet) noexcept override {
    return device_->submit(endpoint, packet);
  }
  IoStatus start_control(const bus::UsbControlRequest& request) noexcept override {
    return device_->start_control(request);
  }
  IoStatus read_control(bus::UsbControlReply& out) noexcept override {
    return device_->read_control(out);
  }
  [[nodiscard]] bus::UsbCounters counters(std::uint8_t endpoint) const noexcept override {
    return device_->counters(endpoint);
  }

 private:
  std::shared_ptr<bus::UsbDevice> device_;  // a task is copied
  devices::DeviceExecutor& executor_;
};

Result<ClaimedBoard> find_and_open(bus::BusEnumerator& buses,
                                   const std::vector<std::string>& last) {
  std::optional<Error> refusal;
  std::vector<bus::BusDeviceInfo> there = buses.list();
  // Before the first of them stand all that are not among them.
  std::ranges::stable_sort(there, {}, [&last](const bus::BusDeviceInfo& info) {
    const auto at = std::ranges::find(last, info.address.text);
    return at == last.end() ? 0 : 1 + (at - last.begin());
  });
  for (const bus::BusDeviceInfo& info : there) {
    const auto match = cambus::match_usb_board(info);
    if (!match) continue;
    auto device = buses.open_usb(info.address, match->claim);
    if (device) return ClaimedBoard{*std::move(device), *match, info.address};
    if (!refusal) refusal = device.error().in(info.address.text);
  }
  if (refusal) return tl::unexpected(*refusal);
  return fail(Errc::NotFound, "no CAM board is plugged in over USB");
}

}  // namespace

BoardSearch::BoardSearch(const BoardPlugs& plugs)
    : buses_(plugs.buses),
      executor_(plugs.executor),
      search_(*plugs.executor, finder(*plugs.buses, {}), "a CAM board is looked for") {}

PlugSearch<ClaimedBoard>::Find BoardSearch::finder(bus::BusEnumerator& buses, Doubted doubted) {
  return [&buses, doubted = std::move(doubted)] { return find_and_open(buses, doubted); };
}

Result<ClaimedBoard> BoardSearch::take(MonotonicTime now) {
  Result<ClaimedBoard> found = search_.take(now);
  if (!found) return found;
  std::erase(doubted_, found->address.text);
  if (doubted_.size() == kMostDoubted) doubted_.erase(doubted_.begin());
  doubted_.push_back(found->address.text);
  search_.look_by(finder(*buses_, doubted_));
  found->device = std::make_unique<ReturnedDevice>(std::move(found->device), *executor_);
  return found;
}

void BoardSearch::note_works() {
  search_.note_works();
  if (!doubted_.empty()) doubted_.pop_back();
  search_.look_by(finder(*buses_, doubted_));
}

}  // namespace thimble::session
