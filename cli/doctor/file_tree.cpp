#include "cli/doctor/file_tree.hpp"

#include <sys/stat.h>
#include <sys/xattr.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <span>

#include "cli/doctor/access_list.hpp"
#include "cli/file_text.hpp"

namespace thimble::doctor {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxAccessListBytes = 4096;  // some 500 entries; those of seats are few

// acl(5), xattr(7): no attribute, or no support for one, means the permission bits alone.
AccessList read_access_list(const fs::path& path) {
  std::array<std::byte, kMaxAccessListBytes> bytes{};
  const ssize_t size =
      ::getxattr(path.c_str(), "system.posix_acl_access", bytes.data(), bytes.size());
  if (size < 0 && (errno == ENODATA || errno == ENOTSUP)) return {};
  AccessList odd;
  odd.is_unreadable = true;
  if (size < 0) return odd;
  return parse_access_list(std::span(bytes).first(static_cast<std::size_t>(size))).value_or(odd);
}

}  // namespace

bool is_this_machine(const fs::path& root) {
  std::error_code error;
  return fs::weakly_canonical(root, error) == "/";
}

std::string FileTree::text(const fs::path& path) const {
  return cli::read_at_most(below_root(path).string(), kMaxTextBytes).value_or("");
}

std::optional<std::vector<std::string>> FileTree::names(const fs::path& path) const {
  std::error_code error;
  std::vector<std::string> names;
  for (fs::directory_iterator entry(below_root(path), error), end; !error && entry != end;
       entry.increment(error)) {
    names.push_back(entry->path().filename().string());
  }
  if (error && names.empty()) return std::nullopt;
  std::sort(names.begin(), names.end());
  return names;
}

Node FileTree::node(const std::string& path) const {
  Node node;
  node.path = path;
  struct stat status {};
  if (::stat(below_root(path).c_str(), &status) != 0) return node;
  node.is_there = true;
  node.mode = status.st_mode & 0777U;
  node.user = status.st_uid;
  node.group = status.st_gid;
  node.access_list = read_access_list(below_root(path));
  if (node.access_list.group_rights) {
    node.mode = (node.mode & ~070U) | *node.access_list.group_rights << 3U;
  }
  return node;
}

std::string FileTree::link(const fs::path& path) const {
  std::error_code error;
  const fs::path target = fs::read_symlink(below_root(path), error);
  return error ? std::string() : target.string();
}

bool FileTree::is_same_file(const fs::path& a, const fs::path& b) const {
  std::error_code error;
  return fs::equivalent(below_root(a), below_root(b), error) && !error;
}

fs::path FileTree::resolved(const fs::path& path) const {
  std::error_code error;
  const fs::path root = fs::canonical(root_, error);
  if (error) return {};
  const fs::path real = fs::canonical(below_root(path), error);
  if (error) return {};
  const fs::path inside = real.lexically_relative(root);
  if (inside.empty() || *inside.begin() == "..") return {};
  return fs::path("/") / inside;
}

}  // namespace thimble::doctor
