#pragma once

#include <memory>

#include "hal/base/time.hpp"
#include "hal/bus/usb_device.hpp"
#include "sim/bus/sim_usb_port.hpp"
#include "sim/model/cam/cam_usb_model.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::sim::cam {

// A whole board on a simulated USB bus of its own: whoever touches what was opened finds bus and
// board as they are at that time. Both run in the thread that does, as SimCamBoard's: a scan is
// done by whom it is for, never by a thread that drives an arm.
//
// The bus stands still while nobody has touched it for longer than kLongest: then it goes on with
// the last of that time.
// Thread: one at a time, with its devices. Ownership: the clock must outlive it, and it its
// devices.
class SimUsbCamBoard {
 public:
  // Ours: as long as what is under way takes at most.
  static constexpr Duration kLongest = std::chrono::milliseconds(100);

  SimUsbCamBoard(const Clock& clock, const BoardOptions& options);

  // What the host's descriptors say of it.
  [[nodiscard]] const bus::BusDeviceInfo& info() const noexcept { return port_.info(); }
  // Errors: as SimPort.
  [[nodiscard]] Result<std::unique_ptr<bus::UsbDevice>> open(const bus::UsbClaim& claim);

  // What may happen to a board.
  void unplug() noexcept;
  void replug() noexcept;
  // It answers, and does nothing any more.
  void freeze() noexcept { model_->freeze(); }

  // Brings bus and board to the present.
  void serve() noexcept;
  [[nodiscard]] CamUsbModel& model() noexcept { return *model_; }

 private:
  SimUsbCamBoard(const Clock& clock, std::unique_ptr<CamUsbModel> model);

  const Clock* clock_;
  Duration behind_;  // the bus's clock, its standstills added up
  VirtualClock bus_clock_;
  CamUsbModel* model_;  // the port's
  SimUsbPort port_;
};

}  // namespace thimble::sim::cam
