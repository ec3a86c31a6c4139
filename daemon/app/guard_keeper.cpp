#include "daemon/app/guard_keeper.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string>
#include <utility>

#include "guard/guard_session.hpp"
#include "guard/handover.hpp"
#include "guard/shared_page.hpp"
#include "hal/linux/helper_socket.hpp"
#include "hal/linux/system_error.hpp"

extern char** environ;  // NOLINT: what a child is given; posix_spawn asks for it

namespace thimble::app {
namespace {

using linux::Descriptor;

constexpr const char* kEnded =
    "it ended; the journal has its word, journalctl -u 'thimble-guard@*'";

guard::Handover handover_of(const linux::SharedDevice& device, const ZeroCommand& zero) {
  guard::Handover handover;
  handover.endpoint = zero.endpoint;
  if (zero.endpoint != 0) handover.route = guard::ZeroRoute::UsbBulk;
  if (device.way == linux::NodeWay::Hiddev) handover.route = guard::ZeroRoute::Hiddev;
  static_assert(ZeroCommand::kMaxBytes + 1 <= guard::kMaxZeroBytes);
  const std::size_t first = device.way == linux::NodeWay::HidrawAfterZero ? 1 : 0;
  std::copy(zero.bytes.begin(), zero.bytes.end(), handover.bytes.begin() + first);
  handover.size = first + zero.bytes.size();
  return handover;
}

}  // namespace

// One arm's: the page stays for the life of the session, a connection for that of a device.
class GuardProcess final : public devices::ArmGuard {
 public:
  GuardProcess(GuardKeeper& keeper, guard::SharedPage page)
      : keeper_(keeper), page_(std::move(page)) {}

  [[nodiscard]] rt::Heartbeat& heartbeat() noexcept override { return page_.heartbeat(); }

  Result<void> ask(const bus::DeviceAddress& address, const ZeroCommand& zero) override {
    give_up();  // the guard of the device before ends
    const auto device = keeper_.settings_.share(address);
    if (!device) return tl::unexpected(device.error());
    auto connection = keeper_.connect();
    if (!connection) return tl::unexpected(connection.error());
    const Result<void> sent = guard::send_handover(connection->get(), handover_of(*device, zero),
                                                   device->node.get(), page_.descriptor());
    if (!sent) return fail(Errc::System, kEnded);
    connection_ = *std::move(connection);
    return {};
  }

  Result<bool> is_watching() override {
    if (connection_.get() < 0) return fail(Errc::System, kEnded);
    char word = 0;
    const ssize_t size = ::recv(connection_.get(), &word, 1, MSG_DONTWAIT);
    if (size < 0 && (errno == EAGAIN || errno == EINTR)) return has_answered_;
    // It has one word to say; whatever else comes is its end.
    if (size == 1 && word == guard::kWatching && !has_answered_) return has_answered_ = true;
    give_up();
    keeper_.reap();
    return fail(Errc::System, kEnded);
  }

 private:
  void give_up() {
    connection_ = Descriptor();
    has_answered_ = false;
  }

  GuardKeeper& keeper_;
  guard::SharedPage page_;
  Descriptor connection_;
  bool has_answered_{false};
};

GuardSettings default_guard_settings() {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  return {"/run/thimble-guard.sock", self.parent_path() / "thimble-guard", {}};
}

GuardKeeper::~GuardKeeper() { reap(); }

Result<std::unique_ptr<devices::ArmGuard>> GuardKeeper::make() {
  reap();
  auto page = guard::SharedPage::create();
  if (!page) return tl::unexpected(page.error());
  return std::make_unique<GuardProcess>(*this, *std::move(page));
}

Result<Descriptor> GuardKeeper::connect() {
  auto connection =
      linux::connect_to_helper(settings_.socket, "(systemctl status thimble-guard.socket)");
  if (connection) return connection;
  const Errc code = connection.error().code;
  const bool has_service = code != Errc::NotFound && code != Errc::InvalidArgument;
  return has_service ? std::move(connection) : start();
}

Result<Descriptor> GuardKeeper::start() {
  reap();
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    return tl::unexpected(linux::system_error("no socket for a guard", errno));
  }
  Descriptor ours(ends[0]);
  const Descriptor its(ends[1]);
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  ::posix_spawn_file_actions_init(&files);
  ::posix_spawn_file_actions_adddup2(&files, its.get(), STDIN_FILENO);
  // Whoever reads the daemon's output waits for no guard; what one has done it says on standard
  // error (decision 0512).
  ::posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  // Whatever was not opened close-on-exec: a port or a client that a guard held would be held by
  // who outlives the daemon.
  ::posix_spawn_file_actions_addclosefrom_np(&files, STDERR_FILENO + 1);
  ::posix_spawnattr_init(&attributes);
  // Signals of the terminal, and of a group, are the daemon's.
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  std::string program = settings_.program.string();
  const std::array<char*, 2> arguments{program.data(), nullptr};
  pid_t pid = 0;
  const int code =
      ::posix_spawn(&pid, program.c_str(), &files, &attributes, arguments.data(), environ);
  ::posix_spawnattr_destroy(&attributes);
  ::posix_spawn_file_actions_destroy(&files);
  if (code != 0) return tl::unexpected(linux::system_error(program + " cannot be started", code));
  started_.push_back(pid);
  return ours;
}

void GuardKeeper::reap() noexcept {
  std::erase_if(started_, [](pid_t pid) { return ::waitpid(pid, nullptr, WNOHANG) != 0; });
}

}  // namespace thimble::app
