#pragma once

#include <memory>
#include <string_view>

struct udev;
struct udev_device;
struct udev_enumerate;
struct udev_monitor;

namespace thimble::linux {

// libudev's handles, given back when they go out of scope.
//
// Thread: that of their context. Not RT. Ownership: one reference each. Errors: nullptr where
// libudev has none.
struct FreeUdev {
  void operator()(udev* context) const noexcept;
  void operator()(udev_device* device) const noexcept;
  void operator()(udev_enumerate* list) const noexcept;
  void operator()(udev_monitor* monitor) const noexcept;
};
template <class Handle>
using UdevHandle = std::unique_ptr<Handle, FreeUdev>;

// What libudev says, empty where it says nothing; it lives as long as the handle that was asked.
[[nodiscard]] inline std::string_view udev_text(const char* text) noexcept {
  return text == nullptr ? std::string_view() : std::string_view(text);
}

}  // namespace thimble::linux
