#include "hal/linux/sysfs_places.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <fnmatch.h>
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
constexpr const char* kPortsThatCome = "tty[!0-9S]*";
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

// Of what is in `folder` under names like `name`, sorted.
std::vector<std::string> paths_in(const std::string& folder, const char* name) {
  std::vector<std::string> paths;
  const std::unique_ptr<DIR, CloseFolder> open(::opendir(folder.c_str()));
  if (open == nullptr) return paths;
  while (const dirent* entry = ::readdir(open.get())) {
    if (entry->d_name[0] == '.' || ::fnmatch(name, entry->d_name, 0) != 0) continue;
    if (auto path = resolved(folder + "/" + entry->d_name)) paths.push_back(*std::move(path));
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

// The number on its bus of the USB device that `path` is below.
std::optional<std::string> number_above(std::string path, const std::string& sys) {
  while (path.size() > sys.size()) {
    path.resize(path.rfind('/'));
    if (auto number = attribute(path, "devnum")) return number;
  }
  return std::nullopt;
}

}  // namespace

std::vector<SysfsPlace> sysfs_places(const std::string& sys) {
  std::vector<SysfsPlace> places;
  for (const std::string& path : paths_in(sys + "/class/hidraw", "*")) {
    places.push_back({path, path});  // the HID device's own count is in it
  }
  for (const std::string& path : paths_in(sys + "/class/tty", kPortsThatCome)) {
    if (const auto number = number_above(path, sys)) places.push_back({path, path + " " + *number});
  }
  // Interfaces have a colon in their names.
  for (const std::string& path : paths_in(sys + "/bus/usb/devices", "*")) {
    const bool is_interface = path.find(':', path.rfind('/')) != std::string::npos;
    if (is_interface || attribute(path, "bDeviceClass") == kHubClass) continue;
    places.push_back({path, path + " " + attribute(path, "devnum").value_or("")});
  }
  return places;
}

}  // namespace thimble::linux
