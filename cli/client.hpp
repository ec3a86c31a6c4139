#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/beast/core/basic_stream.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <chrono>
#include <cstddef>
#include <memory>
#include <string>

#include "hal/base/result.hpp"

namespace thimble::cli {

inline constexpr std::chrono::seconds kTimeout{5};
// A fill of 1024^3 cells takes 2 s, and others may be before it.
inline constexpr std::chrono::seconds kEditTimeout{60};
inline constexpr std::size_t kMaxHeaderBytes = 16384;
inline constexpr std::size_t kMaxReadBytes = 65536;  // that Boost.Beast reads at a time

struct Reply {
  unsigned http_status{0};
  std::string body;
};

// One connection to the daemon; a lease lasts as long as it.
//
// Thread: one. Not RT; every call ends within its timeout.
// Errors: connect() says NotFound when no daemon listens at the path, Timeout when it does not
//         accept, Permission where the place is a stranger's (check_socket_place): nobody is asked
//         there; request() says Disconnected when it has ended, Timeout when it does not answer,
//         Malformed when what it answers is no HTTP, or longer than a daemon's answer.
class Client {
 public:
  [[nodiscard]] static Result<std::unique_ptr<Client>> connect(
      const std::string& socket_path, std::chrono::microseconds timeout = kTimeout);
  [[nodiscard]] Result<Reply> request(const std::string& method, const std::string& target,
                                      const std::string& body = {},
                                      std::chrono::seconds timeout = kTimeout);
  // For poll(): readable when the daemon has closed the connection.
  [[nodiscard]] int descriptor();

 private:
  Client() : stream_(context_) {}

  boost::asio::io_context context_;
  boost::beast::basic_stream<boost::asio::local::stream_protocol> stream_;
  // The extension of a chunk counts neither as header nor as body: only this bounds it.
  boost::beast::flat_buffer buffer_{kMaxHeaderBytes + kMaxReadBytes};
};

}  // namespace thimble::cli
