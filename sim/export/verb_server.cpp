#include "sim/export/verb_server.hpp"

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/write.hpp>
#include <filesystem>
#include <list>
#include <utility>

#include "sim/export/verb.hpp"

namespace thimble::sim {
namespace {

namespace asio = boost::asio;
using Local = asio::local::stream_protocol;
using boost::system::error_code;

// True when the file at `path` is a socket that nobody listens at any more.
bool is_stale(asio::io_context& io, const std::string& path) {
  if (!std::filesystem::is_socket(path)) return false;
  Local::socket probe(io);
  error_code error;
  probe.connect(Local::endpoint(path), error);
  return error == asio::error::connection_refused;
}

}  // namespace

struct VerbServer::Shared {
  Answer answer;
  std::list<Connection*> connections{};  // the one that has been still for the longest time first
};

// Lives as long as something is under way for it.
class VerbServer::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Local::socket socket, std::shared_ptr<Shared> shared)
      : socket_(std::move(socket)), shared_(std::move(shared)) {
    shared_->connections.push_back(this);
  }
  ~Connection() { shared_->connections.remove(this); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void read() {
    asio::async_read_until(socket_, asio::dynamic_buffer(received_, kMaxVerbBytes), '\n',
                           [self = shared_from_this()](error_code error, std::size_t bytes) {
                             if (!error) self->reply(bytes);
                           });
  }
  // What is under way for it ends at once, and it with that.
  void cut_off() {
    error_code ignored;
    socket_.close(ignored);
    shared_->connections.remove(this);
  }

 private:
  void note_move() {
    auto& all = shared_->connections;
    const auto self = std::find(all.begin(), all.end(), this);
    if (self != all.end()) all.splice(all.end(), all, self);
  }
  void reply(std::size_t bytes) {
    note_move();
    if (shared_->answer == nullptr) return;  // the server is gone
    reply_ = shared_->answer(std::string_view(received_).substr(0, bytes - 1));
    received_.erase(0, bytes);
    write();
  }
  void write() {
    if (shared_->answer == nullptr) return;
    note_move();
    piece_ = reply_();
    if (piece_.empty()) return read();
    asio::async_write(socket_, asio::buffer(piece_),
                      [self = shared_from_this()](error_code error, std::size_t) {
                        if (!error) self->write();
                      });
  }

  Local::socket socket_;
  std::shared_ptr<Shared> shared_;
  std::string received_;
  Reply reply_;
  std::string piece_;
};

VerbServer::VerbServer(asio::io_context& io, std::string path, Answer answer)
    : path_(std::move(path)),
      shared_(std::make_shared<Shared>(Shared{std::move(answer)})),
      acceptor_(io) {}

VerbServer::~VerbServer() {
  shared_->answer = nullptr;
  if (!acceptor_.is_open()) return;
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

Result<std::unique_ptr<VerbServer>> VerbServer::listen(asio::io_context& io,
                                                       const std::string& path, Answer answer) {
  constexpr std::size_t kMaxPathBytes = 107;  // sun_path, unix(7)
  if (path.empty() || path.size() > kMaxPathBytes) {
    return fail(Errc::InvalidArgument, "the path of a socket has 1 to 107 bytes");
  }
  std::error_code ignored;
  const auto there = std::filesystem::status(path, ignored);
  if (std::filesystem::exists(there) && !std::filesystem::is_socket(there)) {
    return fail(Errc::InvalidArgument, path + ": is there already, and is no socket");
  }
  if (is_stale(io, path)) std::filesystem::remove(path, ignored);
  std::unique_ptr<VerbServer> server(new VerbServer(io, path, std::move(answer)));
  Local::acceptor acceptor(io);
  error_code error;
  acceptor.open(Local(), error);
  if (!error) acceptor.bind(Local::endpoint(path), error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error) {
    const bool is_taken = error == asio::error::address_in_use;
    return fail(is_taken ? Errc::Busy : Errc::System, path + ": " + error.message());
  }
  server->acceptor_ = std::move(acceptor);
  server->accept();
  return server;
}

void VerbServer::accept() {
  acceptor_.async_accept([this](error_code error, Local::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (!error) {
      if (shared_->connections.size() == kMostConnections) shared_->connections.front()->cut_off();
      std::make_shared<Connection>(std::move(socket), shared_)->read();
    }
    accept();
  });
}

}  // namespace thimble::sim
