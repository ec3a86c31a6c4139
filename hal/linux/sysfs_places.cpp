#include "hal/linux/sysfs_places.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string_view>

// Folders and attributes: the kernel's Documentation/ABI/{stable,testing}/sysfs-bus-usb and
// Documentation/admin-guide/sysfs-rules.rst.
namespace thimble::linux {
namespace {

// The machine's consoles and its own ports are a hundred, of which each look would take a tenth of
// a millisecond from whoever looks; no name of a port on USB begins like theirs.
bool is_port_that_comes(std::string_view name) {
  return name.size() > 3 && name.starts_with("tty") && name[3] != 'S' &&
         (name[3] < '0' || name[3] > '9');
}
bool is_any(std::string_view /*name*/) { return true; }
// Of the names below bus/usb; interfaces have a colon in theirs.
bool is_usb_device(std::string_view name) { return name.find(':') == std::string_view::npos; }

constexpr std::string_view kHubClass = "09";

struct CloseFolder {
  void operator()(DIR* folder) const noexcept { ::closedir(folder); }
};
struct Free {
  void operator()(char* text) const noexcept { std::free(text); }
};

// Without its links; nothing: gone meanwhile.
std::optional<std::string> resolved(const std::string& path) {
  const std::unique_ptr<char, Free> real(::realpath(path.c_str(), nullptr));
  if (real == nullptr) return std::nullopt;
  return std::string(real.get());
}

// Of what is in `folder` under the names that are meant, sorted.
std::vector<std::string> paths_in(const std::string& folder, bool (*is_meant)(std::string_view)) {
  std::vector<std::string> paths;
  const std::unique_ptr<DIR, CloseFolder> open(::opendir(folder.c_str()));
  if (open == nullptr) return paths;
  while (const dirent* entry = ::readdir(open.get())) {
    const std::string_view name = entry->d_name;
    if (name.starts_with('.') || !is_meant(name)) continue;
    if (auto path = resolved(std::string(folder).append("/").append(name)))
      paths.push_back(*std::move(path));
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

std::optional<std::string> attribute(const std::string& path, const char* name) {
  const int file = ::open((path + "/" + name).c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return std::nullopt;
  std::array<char, 32> text{};
  const ssize_t size = ::read(file, text.data(), text.size());
  ::close(file);
  if (size <= 0) return std::nullopt;
  const std::string_view line(text.data(), static_cast<std::size_t>(size));
  return std::string(line.substr(0, line.find('\n')));
}

struct UsbAbove {
  std::string path;
  std::string number;  // on its bus
};

// The USB device that `path` is below.
std::optional<UsbAbove> usb_above(std::string path, const std::string& sys) {
  while (path.size() > sys.size()) {
    path.resize(path.rfind('/'));
    if (auto number = attribute(path, "devnum")) return UsbAbove{path, *std::move(number)};
  }
  return std::nullopt;
}

}  // namespace

std::vector<SysfsPlace> sysfs_places(const std::string& sys) {
  std::vector<SysfsPlace> places;
  for (const std::string& path : paths_in(sys + "/class/hidraw", &is_any)) {
    const auto usb = usb_above(path, sys);
    // The HID device's own count is in its path.
    places.push_back({path, path, usb ? usb->path : path});
  }
  for (const std::string& path : paths_in(sys + "/class/tty", &is_port_that_comes)) {
    const auto usb = usb_above(path, sys);
    if (usb) places.push_back({path, path + " " + usb->number, usb->path});
  }
  for (const std::string& path : paths_in(sys + "/bus/usb/devices", &is_usb_device)) {
    if (attribute(path, "bDeviceClass") == kHubClass) continue;
    places.push_back({path, path + " " + attribute(path, "devnum").value_or(""), path});
  }
  return places;
}

}  // namespace thimble::linux
