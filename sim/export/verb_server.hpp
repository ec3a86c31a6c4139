#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "hal/base/result.hpp"

namespace thimble::sim {

// Answers lines on a Unix socket: each line is given to `answer`, and the pieces of the reply that
// it returns go back, until an empty one. A piece is asked for when the last one has gone, in a
// handler of its own, so whoever runs one handler at a time is never held up for long.
//
// One who sends more than kMaxVerbBytes without a line break is cut off; so is, when there are
// kMostConnections, the one that has been still for the longest time, for who comes anew; while
// somebody takes no replies, no more of his lines are read. Thread: that which runs the io_context.
// Not RT. Ownership: has its socket file, which goes with it. The io_context must outlive it.
class VerbServer {
 public:
  static constexpr std::size_t kMostConnections = 8;  // ours: a test has one, a person a few
  using Reply = std::function<std::string()>;
  using Answer = std::function<Reply(std::string_view line)>;

  // Errors: Busy when somebody listens there, InvalidArgument for a path that is too long or
  // something else than a socket, else System. A socket that nobody listens at is replaced.
  [[nodiscard]] static Result<std::unique_ptr<VerbServer>> listen(boost::asio::io_context& io,
                                                                  const std::string& path,
                                                                  Answer answer);
  ~VerbServer();
  VerbServer(const VerbServer&) = delete;
  VerbServer& operator=(const VerbServer&) = delete;

 private:
  class Connection;
  struct Shared;
  VerbServer(boost::asio::io_context& io, std::string path, Answer answer);
  void accept();

  std::string path_;
  std::shared_ptr<Shared> shared_;
  boost::asio::local::stream_protocol::acceptor acceptor_;
};

}  // namespace thimble::sim
