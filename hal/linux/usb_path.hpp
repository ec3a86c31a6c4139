#pragma once

#include <string>
#include <string_view>

namespace thimble::linux {

// A longer one is none: ours, so that an address with all that it may have about it fits into what
// plugins are told of (THIMBLE_STRING_BYTES).
inline constexpr std::size_t kMaxUsbPathLetters = 80;

// What a USB device is called by its place whatever the kernel counts: by the way to its
// controller, and from there by the ports of the root hub and of hubs, "pci-0000:00:14.0-usb-0:1.4"
// of /sys/devices/pci0000:00/0000:00:14.0/usb3/3-1/3-1.4. As udev's ID_PATH (path_id.c of systemd),
// but with the whole way instead of its last step: a card behind a bridge is called by the bridge,
// "pci-0000:00:1c.4-00.0", since the number of the bus behind that is counted, too (decision 0507).
//
// Left out are what the kernel counts ("usb3", and PLATFORM_DEVID_AUTO of its platform.c,
// "xhci-hcd.1.auto"). A controller has two root hubs at most, one for SuperSpeed, "usbv3-0";
// `root_hub_version` is that one's `version`, " 2.00" or " 3.00". Letters that an address may not
// have become '_': two ways may so be one, which is for hid_address.hpp to see.
//
// Empty: no path of sysfs to a USB device below a controller, or too long.
// Thread: any. Not RT. Pure. Total: any texts.
[[nodiscard]] std::string usb_path_of(std::string_view sysfs_path,
                                      std::string_view root_hub_version);

// The path of its root hub, "/sys/devices/pci0000:00/0000:00:14.0/usb3"; empty: none.
// Thread: any. Not RT. Pure. Total.
[[nodiscard]] std::string_view root_hub_above(std::string_view sysfs_path);

}  // namespace thimble::linux
