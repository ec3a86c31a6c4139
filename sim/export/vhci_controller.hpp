#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "hal/base/result.hpp"

namespace thimble::sim {

// The number of a port that has nothing, of those for devices below 5 Gbit/s; nullopt: none has.
// `status`: the file of that name in the controller's folder.
[[nodiscard]] std::optional<unsigned> free_vhci_port(std::string_view status);

// This kernel's own end of USB/IP (module vhci-hcd): a host controller whose devices are whatever
// is at the other end of sockets that it is given. `usbip attach` gives it such of TCP; it takes
// any stream (linux drivers/usb/usbip/vhci_sysfs.c, attach_store).
//
// Thread: one. RT: no; it writes a file. Needs root.
class VhciController {
 public:
  static constexpr const char* kFolder = "/sys/devices/platform/vhci_hcd.0";

  // `folder`: for tests, another one.
  explicit VhciController(std::string folder = kFolder) : folder_(std::move(folder)) {}

  // Plugs in a full-speed device: `socket` is the kernel's end, connected, of which it has its own
  // hold afterwards. `device_id`: in each message about that device.
  // Errors: NotFound without the module, Permission, Busy when every port has a device, System.
  [[nodiscard]] Result<void> attach(int socket, std::uint32_t device_id) const;

 private:
  [[nodiscard]] Result<unsigned> free_port() const;

  std::string folder_;
};

}  // namespace thimble::sim
