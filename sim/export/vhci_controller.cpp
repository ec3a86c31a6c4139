#include "sim/export/vhci_controller.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <sstream>

#include "hal/linux/descriptor.hpp"
#include "hal/linux/system_error.hpp"

namespace thimble::sim {
namespace {

constexpr std::size_t kStatusBytes = 4096;  // sysfs gives no more of a file
constexpr const char* kHighSpeedHub = "hs";
constexpr unsigned kPortIsFree = 4;  // VDEV_ST_NULL, drivers/usb/usbip/usbip_common.h
constexpr unsigned kFullSpeed = 2;   // USB_SPEED_FULL, linux/usb/ch9.h
// Ours: as many as the controller has ports, should others take each that is seen free.
constexpr int kMostTries = 8;

Result<void> refused(const std::string& path, int error) {
  if (error == ENOENT) {
    return fail(Errc::NotFound, "this kernel has no USB/IP host: modprobe vhci-hcd");
  }
  if (error == EBUSY) return fail(Errc::Busy, path + ": every port has a device");
  return tl::unexpected(linux::system_error(path, error));
}

}  // namespace

std::optional<unsigned> free_vhci_port(std::string_view status) {
  std::istringstream lines{std::string(status)};
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string hub;
    unsigned port = 0;
    unsigned state = 0;
    if (words >> hub >> port >> state && hub == kHighSpeedHub && state == kPortIsFree) return port;
  }
  return std::nullopt;
}

Result<unsigned> VhciController::free_port() const {
  const std::string path = folder_ + "/status";
  const linux::Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  std::array<char, kStatusBytes> text;
  const ssize_t size = file.get() < 0 ? -1 : ::read(file.get(), text.data(), text.size());
  if (size < 0) return tl::unexpected(refused(path, errno).error());
  const auto port = free_vhci_port({text.data(), static_cast<std::size_t>(size)});
  if (!port) return tl::unexpected(refused(path, EBUSY).error());
  return *port;
}

Result<void> VhciController::attach(int socket, std::uint32_t device_id) const {
  const std::string path = folder_ + "/attach";
  int error = 0;
  for (int i = 0; i < kMostTries; ++i) {
    const Result<unsigned> port = free_port();
    if (!port) return tl::unexpected(port.error());
    const std::string words = std::to_string(*port) + " " + std::to_string(socket) + " " +
                              std::to_string(device_id) + " " + std::to_string(kFullSpeed);
    const linux::Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
    if (file.get() >= 0 && ::write(file.get(), words.data(), words.size()) >= 0) return {};
    error = errno;
    if (error != EBUSY) break;  // else somebody was faster
  }
  return refused(path, error);
}

}  // namespace thimble::sim
