#include "sim/model/cam/sim_usb_cam_board.hpp"

#include <utility>

#include "drivers/cambus/cambus_usb_wire.hpp"

namespace thimble::sim::cam {
namespace {

// Brings the bus to the present before it is looked at.
class ServedDevice final : public bus::UsbDevice {
 public:
  ServedDevice(SimUsbCamBoard& board, std::unique_ptr<bus::UsbDevice> device)
      : board_(&board), device_(std::move(device)) {}

  IoStatus read(std::uint8_t endpoint, bus::UsbPacket& out) noexcept override {
    board_->serve();
    return device_->read(endpoint, out);
  }
  IoStatus submit(std::uint8_t endpoint, std::span<const std::uint8_t> packet) noexcept override {
    board_->serve();
    return device_->submit(endpoint, packet);
  }
  IoStatus start_control(const bus::UsbControlRequest& request) noexcept override {
    board_->serve();
    return device_->start_control(request);
  }
  IoStatus read_control(bus::UsbControlReply& out) noexcept override {
    board_->serve();
    return device_->read_control(out);
  }
  [[nodiscard]] bus::UsbCounters counters(std::uint8_t endpoint) const noexcept override {
    return device_->counters(endpoint);
  }

 private:
  SimUsbCamBoard* board_;
  std::unique_ptr<bus::UsbDevice> device_;
};

}  // namespace

SimUsbCamBoard::SimUsbCamBoard(const Clock& clock, const BoardOptions& options)
    : SimUsbCamBoard(clock, std::make_unique<CamUsbModel>(options)) {}

SimUsbCamBoard::SimUsbCamBoard(const Clock& clock, std::unique_ptr<CamUsbModel> model)
    : clock_(&clock),
      behind_(clock.now().since_epoch),
      model_(model.get()),
      port_(bus_clock_, {"sim:cam-8"}, std::move(model)) {}

Result<std::unique_ptr<bus::UsbDevice>> SimUsbCamBoard::open(const bus::UsbClaim& claim) {
  serve();
  auto device = port_.open_usb(claim);
  if (!device) return tl::unexpected(device.error());
  return std::make_unique<ServedDevice>(*this, *std::move(device));
}

void SimUsbCamBoard::unplug() noexcept {
  serve();
  port_.unplug();
}

void SimUsbCamBoard::replug() noexcept {
  serve();
  port_.replug();
}

void SimUsbCamBoard::serve() noexcept {
  MonotonicTime there{clock_->now().since_epoch - behind_};
  const Duration missed = there - bus_clock_.now();
  if (missed > kLongest) {
    behind_ += missed - kLongest;
    there = bus_clock_.now() + kLongest;
  }
  bus_clock_.sleep_until(there);
}

}  // namespace thimble::sim::cam
