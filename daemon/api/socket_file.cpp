#include "daemon/api/socket_file.hpp"

#include <fcntl.h>
#include <grp.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <exception>
#include <filesystem>
#include <utility>

namespace thimble::api {
namespace {

constexpr int kBacklog = 64;

tl::unexpected<Error> fail_errno(const std::string& what) {
  const int code = errno;
  const bool is_right = code == EACCES || code == EPERM;
  return fail(is_right ? Errc::Permission : Errc::System, what + ": " + std::strerror(code));
}

sockaddr_un address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path.data(), path.size());
  return address;
}

int call_with(int (*function)(int, const sockaddr*, socklen_t), int socket,
              const std::string& path) {
  const sockaddr_un address = address_of(path);
  return function(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address);
}

// The folder of the socket, made when missing: open to everybody's eyes where the whole
// machine uses it, else the user's own.
Result<void> prepare_directory(const std::string& socket_path, bool is_shared) {
  const auto folder = std::filesystem::path(socket_path).parent_path();
  if (folder.empty()) return {};
  if (::mkdir(folder.c_str(), is_shared ? 0755 : 0700) == 0) return {};
  if (errno != EEXIST) return fail_errno("cannot make the folder " + folder.string());
  struct stat info {};
  if (::stat(folder.c_str(), &info) != 0) return fail_errno(folder.string());
  // Somebody else's folder (say, /tmp/thimble-UID made first by another user) would let them
  // put another socket in our place.
  if (info.st_uid != 0 && info.st_uid != ::geteuid()) {
    return fail(Errc::Permission, "the folder " + folder.string() + " belongs to another user");
  }
  return {};
}

Result<gid_t> find_group(const std::string& name) {
  const group* entry = ::getgrnam(name.c_str());
  if (entry == nullptr) return fail(Errc::NotFound, "there is no group \"" + name + "\"");
  return entry->gr_gid;
}

Result<void> refuse_other_than_socket(const std::string& path, const struct stat& info) {
  if (S_ISSOCK(info.st_mode)) return {};
  return fail(Errc::InvalidArgument, path + " exists and is no socket; it is left alone");
}

}  // namespace

Result<void> check_socket_path(const std::string& path) {
  if (path.empty() || path.size() >= sizeof(sockaddr_un::sun_path)) {
    return fail(Errc::InvalidArgument, "the path of a socket has 1 to " +
                                           std::to_string(sizeof(sockaddr_un::sun_path) - 1) +
                                           " bytes, \"" + path + "\" has " +
                                           std::to_string(path.size()));
  }
  struct stat info {};
  if (::lstat(path.c_str(), &info) != 0) return {};
  return refuse_other_than_socket(path, info);
}

Result<void> check_socket_group(const std::string& name) {
  const Result<gid_t> found = find_group(name);
  if (!found) return tl::unexpected<Error>(found.error());
  return {};
}

Result<SocketFile> SocketFile::create(const SocketFileSettings& settings) {
  if (auto may_be = check_socket_path(settings.path); !may_be) {
    return tl::unexpected<Error>(may_be.error());
  }
  SocketFile out;
  out.path_ = settings.path;
  const bool is_shared = !settings.group.empty() || ::geteuid() == 0;
  auto done = prepare_directory(settings.path, is_shared);
  if (done) done = out.take_lock();
  if (done) done = out.remove_stale();
  if (done) done = out.listen(settings);
  if (!done) return tl::unexpected<Error>(done.error());
  return out;
}

SocketFile::SocketFile(SocketFile&& other) noexcept
    : path_(std::move(other.path_)),
      lock_(std::exchange(other.lock_, -1)),
      socket_(std::exchange(other.socket_, -1)),
      is_bound_(std::exchange(other.is_bound_, false)),
      has_replaced_stale_(other.has_replaced_stale_) {}

SocketFile::~SocketFile() {
  if (is_bound_ && std::uncaught_exceptions() == 0) ::unlink(path_.c_str());
  if (socket_ >= 0) ::close(socket_);
  if (lock_ >= 0) ::close(lock_);
}

int SocketFile::release_descriptor() noexcept { return std::exchange(socket_, -1); }

Result<void> SocketFile::busy() const {
  return fail(Errc::Busy, "another daemon is running at " + path_ +
                              "; end it, or give this one a place of its own with daemon.socket");
}

Result<void> SocketFile::take_lock() {
  const std::string lock_path = path_ + ".lock";
  lock_ = ::open(lock_path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (lock_ < 0) return fail_errno("cannot open " + lock_path);
  if (::flock(lock_, LOCK_EX | LOCK_NB) == 0) return {};
  if (errno != EWOULDBLOCK) return fail_errno("cannot lock " + lock_path);
  return busy();
}

Result<void> SocketFile::remove_stale() {
  struct stat info {};
  if (::lstat(path_.c_str(), &info) != 0) {
    if (errno == ENOENT) return {};
    return fail_errno(path_);
  }
  if (auto is_socket = refuse_other_than_socket(path_, info); !is_socket) return is_socket;
  const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (probe < 0) return fail_errno("socket");
  const bool is_refused = call_with(::connect, probe, path_) != 0 && errno == ECONNREFUSED;
  ::close(probe);
  if (!is_refused) return busy();
  if (::unlink(path_.c_str()) != 0) return fail_errno("cannot remove the stale socket " + path_);
  has_replaced_stale_ = true;
  return {};
}

Result<void> SocketFile::listen(const SocketFileSettings& settings) {
  socket_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket_ < 0) return fail_errno("socket");
  // Linux takes the file's first mode from the descriptor (unix_bind): nobody slips in between
  // bind() and chmod().
  ::fchmod(socket_, 0600);
  if (call_with(::bind, socket_, path_) != 0) return fail_errno("cannot make " + path_);
  is_bound_ = true;
  if (!settings.group.empty()) {
    const auto group = find_group(settings.group);
    if (!group) return tl::unexpected<Error>(group.error());
    if (::chown(path_.c_str(), static_cast<uid_t>(-1), *group) != 0) {
      return fail_errno("cannot give " + path_ + " to the group " + settings.group);
    }
  }
  if (::chmod(path_.c_str(), settings.mode) != 0) return fail_errno("cannot chmod " + path_);
  if (::listen(socket_, kBacklog) != 0) return fail_errno("cannot listen at " + path_);
  return {};
}

}  // namespace thimble::api
