#pragma once

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "daemon/api/commands.hpp"
#include "daemon/api/status_view.hpp"
#include "hal/base/result.hpp"

namespace thimble::api {

struct ServerSettings {
  std::string socket_path;
  std::uint32_t socket_mode{0660};
  std::string group;  // empty: that of the process
  // Ours: a person's tools send a few hundred bytes and ask a few times a second; kMaxEdits
  // brushes with every digit of their numbers take 10 KB.
  std::size_t max_header_bytes{8192};
  std::size_t max_body_bytes{16384};
  std::size_t max_state_bytes{16384};  // of a world's saved state; who has worlds knows their most
  // One more makes a silent one go that holds no lease (seats.hpp): who sets it leaves room for
  // such beside every arm's holder.
  std::size_t max_connections{32};
  // Not for who holds a lease or gave a steady force.
  std::chrono::milliseconds idle_timeout{30000};
  std::chrono::milliseconds write_timeout{5000};  // a reader slower than that is dropped
};

// HTTP/1.1 with JSON on a Unix stream socket (docs/api.md). A connection that activated an arm
// holds its lease until it closes.
//
// Thread: all of it runs on the one thread that runs `context`, the constructor and destructor
//         too. Not RT.
// Ownership: `context`, `view` and `commands` must outlive it; handlers that are still queued
//            when it is destroyed do nothing. The socket file is removed with it.
// Errors: create() says Busy when another daemon listens at the path; see SocketFile.
class Server {
 public:
  [[nodiscard]] static Result<std::unique_ptr<Server>> create(boost::asio::io_context& context,
                                                              const ServerSettings& settings,
                                                              const StatusView& view,
                                                              Commands& commands);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  [[nodiscard]] std::size_t connections() const noexcept;
  // Whether the daemon that listened here before was killed or came to grief.
  [[nodiscard]] bool has_replaced_dead_one() const noexcept;

 private:
  class Core;
  explicit Server(std::shared_ptr<Core> core);
  std::shared_ptr<Core> core_;  // shared with the handlers in flight
};

}  // namespace thimble::api
