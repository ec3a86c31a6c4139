#include "daemon/api/server.hpp"

#include <fcntl.h>
#include <sys/socket.h>

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/steady_timer.hpp>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/api/connection.hpp"
#include "daemon/api/seats.hpp"
#include "daemon/api/socket_file.hpp"

namespace thimble::api {
namespace {

namespace net = boost::asio;
using Protocol = net::local::stream_protocol;

constexpr std::string_view kFull =
    "HTTP/1.1 503 Service Unavailable\r\nContent-Type: application/json\r\n"
    "Content-Length: 76\r\nConnection: close\r\n\r\n"
    R"({"error": {"code": "busy", "message": "too many connections to the daemon"}})";
static_assert(kFull.substr(kFull.find("\r\n\r\n") + 4).size() == 76);

// Between tries while the process is out of descriptors.
constexpr std::chrono::milliseconds kAcceptPause{100};

// Whose process made the connection (unix(7)). Where the kernel does not say, as nobody's.
UserId user_of(Protocol::socket& socket) noexcept {
  ucred peer{};
  socklen_t size = sizeof peer;
  const int told = ::getsockopt(socket.native_handle(), SOL_SOCKET, SO_PEERCRED, &peer, &size);
  return told == 0 ? peer.uid : static_cast<UserId>(-1);
}

}  // namespace

// The part of the server that handlers in flight keep alive.
class Server::Core : public std::enable_shared_from_this<Core> {
 public:
  Core(net::io_context& context, ServerSettings settings, const StatusView& view,
       Commands& commands, SocketFile file)
      : settings_(std::move(settings)),
        view_(view),
        commands_(commands),
        file_(std::move(file)),
        acceptor_(context, Protocol(), file_->release_descriptor()),
        pause_(context) {}

  void accept() {
    acceptor_.async_accept(
        [self = shared_from_this()](boost::system::error_code error, Protocol::socket socket) {
          self->on_accept(error, std::move(socket));
        });
  }

  void stop() {
    is_stopped_ = true;
    boost::system::error_code ignored;
    acceptor_.close(ignored);
    pause_.cancel();
    while (!connections_.empty()) {
      // A copy: closing takes it out of the map.
      const std::shared_ptr<Connection> connection = connections_.begin()->second.connection;
      connection->close();
    }
    file_.reset();
  }

  [[nodiscard]] std::size_t connections() const noexcept { return connections_.size(); }
  [[nodiscard]] bool has_replaced_dead_one() const noexcept {
    return file_ && file_->has_replaced_stale();
  }

 private:
  void on_accept(boost::system::error_code error, Protocol::socket socket) {
    if (is_stopped_) return;
    if (error) return accept_later();
    // No program that the daemon starts holds a client's connection open (Asio 1.81 accepts without
    // SOCK_CLOEXEC).
    ::fcntl(socket.native_handle(), F_SETFD, FD_CLOEXEC);
    const UserId user = user_of(socket);
    if (has_room_for(user)) {
      add(std::move(socket), user);
    } else {
      refuse(std::move(socket));
    }
    accept();
  }

  void accept_later() {
    pause_.expires_after(kAcceptPause);
    pause_.async_wait([self = shared_from_this()](boost::system::error_code) {
      if (!self->is_stopped_) self->accept();
    });
  }

  // Makes it where there is none.
  bool has_room_for(UserId newcomer) {
    if (connections_.size() < settings_.max_connections) return true;
    std::vector<Seat> seats;
    for (const auto& [id, entry] : connections_) {
      seats.push_back({id, entry.user, entry.moved, entry.connection->holds_lease()});
    }
    const std::optional<ClientId> goes = who_goes(seats, newcomer);
    if (!goes) return false;
    // A copy, as in stop().
    const std::shared_ptr<Connection> connection = connections_.at(*goes).connection;
    connection->close();
    return true;
  }

  static void refuse(Protocol::socket socket) {
    boost::system::error_code ignored;
    socket.non_blocking(true, ignored);
    socket.write_some(net::buffer(kFull), ignored);
  }

  void add(Protocol::socket socket, UserId user) {
    const ClientId id{++last_id_};
    const auto note = [this](ClientId moved) { connections_.at(moved).moved = ++moves_; };
    const auto forget = [this](ClientId gone) { connections_.erase(gone); };
    const auto connection = std::make_shared<Connection>(
        std::move(socket), id, Connection::Context{settings_, view_, commands_, note, forget});
    connections_.emplace(id, Entry{connection, user, ++moves_});
    connection->start();
  }

  struct Entry {
    std::shared_ptr<Connection> connection;
    UserId user;
    std::uint64_t moved;  // as Seat::moved
  };

  ServerSettings settings_;
  const StatusView& view_;
  Commands& commands_;
  std::optional<SocketFile> file_;
  Protocol::acceptor acceptor_;
  net::steady_timer pause_;
  std::map<ClientId, Entry> connections_;
  std::uint64_t last_id_{0};
  std::uint64_t moves_{0};  // of all
  bool is_stopped_{false};
};

Result<std::unique_ptr<Server>> Server::create(net::io_context& context,
                                               const ServerSettings& settings,
                                               const StatusView& view, Commands& commands) {
  auto file = SocketFile::create({settings.socket_path, settings.socket_mode, settings.group});
  if (!file) return tl::unexpected<Error>(std::move(file.error()));
  auto core = std::make_shared<Core>(context, settings, view, commands, std::move(*file));
  core->accept();
  return std::unique_ptr<Server>(new Server(std::move(core)));
}

Server::Server(std::shared_ptr<Core> core) : core_(std::move(core)) {}

Server::~Server() { core_->stop(); }

bool Server::has_replaced_dead_one() const noexcept { return core_->has_replaced_dead_one(); }

std::size_t Server::connections() const noexcept { return core_->connections(); }

}  // namespace thimble::api
