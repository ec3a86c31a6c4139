#include "hal/linux/udev_handles.hpp"

#include <libudev.h>

namespace thimble::linux {

void FreeUdev::operator()(udev* context) const noexcept { ::udev_unref(context); }
void FreeUdev::operator()(udev_device* device) const noexcept { ::udev_device_unref(device); }
void FreeUdev::operator()(udev_enumerate* list) const noexcept { ::udev_enumerate_unref(list); }
void FreeUdev::operator()(udev_monitor* monitor) const noexcept { ::udev_monitor_unref(monitor); }

}  // namespace thimble::linux
