#include "daemon/session/board_search.hpp"

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

Result<ClaimedBoard> find_and_open(bus::BusEnumerator& buses) {
  std::optional<Error> refusal;
  for (const bus::BusDeviceInfo& info : buses.list()) {
    const auto match = cambus::match_usb_board(info);
    if (!match) continue;
    auto device = buses.open_usb(info.address, match->claim);
    if (device) return ClaimedBoard{*std::move(device), *match};
    if (!refusal) refusal = device.error().in(info.address.text);
  }
  if (refusal) return tl::unexpected(*refusal);
  return fail(Errc::NotFound, "no CAM board is plugged in over USB");
}

}  // namespace

BoardSearch::BoardSearch(const BoardPlugs& plugs)
    : executor_(plugs.executor),
      search_(
          *plugs.executor, [buses = plugs.buses] { return find_and_open(*buses); },
          "a CAM board is looked for") {}

Result<ClaimedBoard> BoardSearch::take(MonotonicTime now) {
  Result<ClaimedBoard> found = search_.take(now);
  if (found) {
    found->device = std::make_unique<ReturnedDevice>(std::move(found->device), *executor_);
  }
  return found;
}

}  // namespace thimble::session
