#pragma once

#include <boost/asio/local/stream_protocol.hpp>
#include <boost/beast/core/basic_stream.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "daemon/api/request.hpp"
#include "daemon/api/server.hpp"

namespace thimble::api {

// One client of the server: reads a request, answers it, reads the next.
//
// Thread: the server's. Not RT.
// Ownership: by the server's list and by the handler in flight (hence shared); `on_closed` is
//            called once, and after close() nothing of the outside is touched any more.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  using Socket = boost::asio::local::stream_protocol::socket;
  struct Context {
    const ServerSettings& settings;
    const StatusView& view;
    Commands& commands;
    std::function<void(ClientId)> on_moved;  // it asked something whole, or has its answer
    std::function<void(ClientId)> on_closed;
  };

  Connection(Socket socket, ClientId id, Context context);
  void start() { read(); }
  void close();
  [[nodiscard]] bool holds_lease() const;

 private:
  using Stream = boost::beast::basic_stream<boost::asio::local::stream_protocol>;
  using Request = boost::beast::http::request<boost::beast::http::string_body>;
  using Parser = boost::beast::http::request_parser<boost::beast::http::string_body>;
  using Response = boost::beast::http::response<boost::beast::http::string_body>;

  // As the status tells it.
  struct Lease {
    std::string holder{"none"};
    std::uint64_t number{0};
  };

  void read();
  void on_header(boost::beast::error_code error);
  void on_read(boost::beast::error_code error);
  void answer_and_close(const RequestError& error);
  void write(bool is_kept);

  void perform(const Request& request);
  void command(Action action, bool is_kept);
  void watch_for_hang_up();
  void on_done(const Action& action, const Result<Done>& done, bool is_kept);
  void on_edited(const std::string& world, const Result<Edited>& edited, bool is_kept);
  void on_pieces(const std::string& world, const Result<PieceDone>& done, bool is_kept);
  void on_loaded(const std::string& world, const Result<std::uint64_t>& steps, bool is_kept);
  [[nodiscard]] FileAnswer file_answer(bool is_kept);
  void respond(tl::expected<std::string, RequestError> body, bool is_kept,
               std::string_view content_type = "application/json");
  [[nodiscard]] Lease lease_of(const std::string& arm) const;
  void prepare(unsigned status, std::string body, bool is_kept, std::string_view content_type);

  Stream stream_;
  ClientId id_;
  Context context_;
  boost::beast::flat_buffer buffer_;
  std::optional<Parser> parser_;
  Response response_;
  std::map<std::string, std::uint64_t> leases_;  // of the arms that this client activated: number
  bool has_commanded_{false};
  bool has_pushed_{false};  // by a steady force, while a person looks at a scale
  bool is_closed_{false};
};

}  // namespace thimble::api
