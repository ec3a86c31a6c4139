#pragma once

#include <cstdint>
#include <string>

#include "hal/base/result.hpp"

namespace thimble::api {

struct SocketFileSettings {
  std::string path;
  std::uint32_t mode{0660};
  std::string group;  // empty: that of the process
};

// What create() below would refuse, as far as it is seen before anything is made: a path that is
// too long or taken by what is no socket (InvalidArgument), a group that is not there (NotFound).
// Thread: any, not RT.
[[nodiscard]] Result<void> check_socket_path(const std::string& path);
[[nodiscard]] Result<void> check_socket_group(const std::string& name);

// A listening Unix stream socket in the file system, removed again by the destructor, unless an
// exception destroys it: a name that is left behind says that its daemon came to grief. A lock
// file beside it (PATH.lock, left behind) decides who may replace a stale one.
//
// Thread: one. Not RT.
// Ownership: of the lock and of the name in the file system; the descriptor is given away.
// Errors: Busy when another daemon listens there, InvalidArgument for a path that is too long
// or taken by something else, NotFound for the group, Permission or System otherwise.
class SocketFile {
 public:
  [[nodiscard]] static Result<SocketFile> create(const SocketFileSettings& settings);
  SocketFile(SocketFile&& other) noexcept;
  SocketFile& operator=(SocketFile&&) = delete;
  ~SocketFile();

  // The listening descriptor, once; the caller closes it.
  [[nodiscard]] int release_descriptor() noexcept;
  // The one that had the name before did not live to remove it.
  [[nodiscard]] bool has_replaced_stale() const noexcept { return has_replaced_stale_; }

 private:
  SocketFile() = default;
  Result<void> take_lock();
  [[nodiscard]] Result<void> busy() const;
  Result<void> remove_stale();
  Result<void> listen(const SocketFileSettings& settings);

  std::string path_;
  int lock_{-1};
  int socket_{-1};
  bool is_bound_{false};
  bool has_replaced_stale_{false};
};

}  // namespace thimble::api
