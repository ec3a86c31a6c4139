#include "cli/socket_group.hpp"

#include <grp.h>
#include <pwd.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <string_view>

#include "cli/text.hpp"

namespace thimble::cli {
namespace {

// Groups of Debian whose members read or write what is not theirs, or become root (base-passwd's
// users-and-groups; docker, lxd, libvirt: of those programs' own manuals), and `thimble`, whose
// members may push with the arms (decision 0275).
constexpr std::array<std::string_view, 17> kPrivilegedGroups{
    "adm", "disk",  "docker", "input",           "kmem",    "libvirt", "lxd",  "root", "shadow",
    "src", "staff", "sudo",   "systemd-journal", "thimble", "tty",     "utmp", "wheel"};

// The group that owns the socket, or the folder around it that keeps people out.
std::optional<gid_t> group_of(const std::string& socket_path) {
  struct stat info {};
  if (::stat(socket_path.c_str(), &info) != 0) {
    const std::string folder = std::filesystem::path(socket_path).parent_path().string();
    if (::stat(folder.c_str(), &info) != 0) return std::nullopt;
  }
  return info.st_gid;
}

}  // namespace

bool is_for_people(gid_t number, const std::string& name) {
  if (number == 0) return false;
  if (std::find(kPrivilegedGroups.begin(), kPrivilegedGroups.end(), name) !=
      kPrivilegedGroups.end()) {
    return false;
  }
  // Of a service or a person: who joins it reaches their files.
  const passwd* account = ::getpwnam(name.c_str());
  return account == nullptr || account->pw_gid != number;
}

std::string advice_to_join(const std::string& socket_path) {
  const std::optional<gid_t> number = group_of(socket_path);
  if (!number) return "; become a member of the group that owns this socket";
  const group* found = ::getgrgid(*number);
  const std::string name = found != nullptr ? found->gr_name : "";
  if (!is_for_people(*number, name)) {
    return "; nobody should join its group, " +
           (name.empty() ? std::to_string(*number) : plain(name)) +
           ", for this: set daemon.group = \"thimble-users\" in the daemon's configuration, start "
           "the daemon anew, and become a member of thimble-users";
  }
  if (name.empty()) return "; become a member of the group that owns this socket";
  return "; become a member of its group: sudo adduser \"$USER\" " + plain(name) +
         ", then log in anew";
}

}  // namespace thimble::cli
