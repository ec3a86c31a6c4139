#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cli/doctor/facts.hpp"

namespace thimble::doctor {

// What a text of the kernel may have: the longest, /proc/PID/status, names up to NGROUPS_MAX
// (65536) groups of at most eleven columns each.
inline constexpr std::size_t kMaxTextBytes = std::size_t{1} << 20;

// Whether a folder is "/", by whatever name.
[[nodiscard]] bool is_this_machine(const std::filesystem::path& root);

// A folder that holds /proc, /sys, /dev and /etc of a machine. Never throws for what is missing,
// forbidden or gone in the middle of it, as processes go.
// Thread: any. Not RT.
class FileTree {
 public:
  explicit FileTree(std::filesystem::path root) : root_(std::move(root)) {}

  // `path` is absolute, as on the machine. Its first kMaxTextBytes; empty when it cannot be read.
  [[nodiscard]] std::string text(const std::filesystem::path& path) const;
  // Names in a folder, sorted; nothing when it may not be read.
  [[nodiscard]] std::optional<std::vector<std::string>> names(
      const std::filesystem::path& path) const;
  // The same; none when it may not be read.
  [[nodiscard]] std::vector<std::string> names_in(const std::filesystem::path& path) const {
    return names(path).value_or(std::vector<std::string>{});
  }
  // Where that file is for who opens it.
  [[nodiscard]] std::string place_of(const std::filesystem::path& path) const {
    return below_root(path).string();
  }
  [[nodiscard]] Node node(const std::string& path) const;
  // What a symbolic link says; empty when it is none.
  [[nodiscard]] std::string link(const std::filesystem::path& path) const;
  // Whether both are there and one file, links followed.
  [[nodiscard]] bool is_same_file(const std::filesystem::path& a,
                                  const std::filesystem::path& b) const;
  // The folder behind all symbolic links, as a path of the machine; empty when it leaves the tree.
  [[nodiscard]] std::filesystem::path resolved(const std::filesystem::path& path) const;

 private:
  [[nodiscard]] std::filesystem::path below_root(const std::filesystem::path& path) const {
    return root_ / path.relative_path();
  }

  std::filesystem::path root_;
};

}  // namespace thimble::doctor
