#include "cli/client.hpp"

#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>

#include <boost/beast/http.hpp>
#include <cerrno>

#include "cli/socket_group.hpp"
#include "cli/text.hpp"
#include "daemon/config/socket_place.hpp"

namespace thimble::cli {
namespace {

namespace beast = boost::beast;
namespace http = boost::beast::http;

constexpr std::size_t kMaxBodyBytes = std::size_t{1} << 22;
constexpr unsigned kHttp11 = 11;

tl::unexpected<Error> refusal(const boost::system::error_code& error,
                              const std::string& socket_path) {
  const std::string path = plain(socket_path);
  namespace errc = boost::system::errc;
  if (error == errc::no_such_file_or_directory || error == errc::connection_refused) {
    return fail(Errc::NotFound, "no daemon is running at " + path);
  }
  if (error == errc::permission_denied) {
    return fail(Errc::Permission,
                "you may not talk to the daemon at " + path + advice_to_join(socket_path));
  }
  if (error == errc::resource_unavailable_try_again) {
    return fail(Errc::Timeout, "the daemon at " + path + " does not accept anybody");
  }
  return fail(Errc::System, "cannot connect to " + path + ": " + error.message());
}

tl::unexpected<Error> failure(const beast::error_code& error) {
  if (error == beast::error::timeout) {
    return fail(Errc::Timeout, "the daemon does not answer");
  }
  if (error.category() == http::make_error_code(http::error::bad_version).category() &&
      error != http::error::end_of_stream && error != http::error::partial_message) {
    return fail(Errc::Malformed, "the answer is not the daemon's: " + error.message());
  }
  return fail(Errc::Disconnected,
              "the daemon hung up: it has ended, or too many others talk to it");
}

// Not boost's: a local socket that does not block is refused at once when the daemon is behind
// with accepting, and boost takes that for a connection. The time-out of sending bounds a blocking
// connect() too (unix(7), SO_SNDTIMEO in socket(7)).
boost::system::error_code connect_within(std::chrono::microseconds timeout, int descriptor,
                                         const boost::asio::local::stream_protocol::endpoint& to) {
  constexpr std::chrono::microseconds::rep kPerSecond = 1'000'000;
  const timeval limit{timeout.count() / kPerSecond, timeout.count() % kPerSecond};
  if (::setsockopt(descriptor, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit) != 0 ||
      ::connect(descriptor, to.data(), static_cast<socklen_t>(to.size())) != 0) {
    return {errno, boost::system::system_category()};
  }
  return {};
}

}  // namespace

Result<std::unique_ptr<Client>> Client::connect(const std::string& socket_path,
                                                std::chrono::microseconds timeout) {
  if (socket_path.empty() || socket_path.size() >= sizeof(sockaddr_un::sun_path)) {
    return fail(Errc::InvalidArgument,
                "a socket cannot have the path \"" + plain(socket_path) + "\"");
  }
  // What is sent to a stranger they may tell otherwise, and what they answer is no arm's.
  const auto place = config::check_socket_place(socket_path);
  if (!place && place.error().code == Errc::NotFound) {
    return refusal(
        boost::system::errc::make_error_code(boost::system::errc::no_such_file_or_directory),
        socket_path);
  }
  if (!place) return fail(place.error().code, plain(place.error().message));
  std::unique_ptr<Client> out(new Client);
  boost::system::error_code error;
  const boost::asio::local::stream_protocol::endpoint endpoint(socket_path);
  out->stream_.socket().open(endpoint.protocol(), error);
  if (!error) error = connect_within(timeout, out->descriptor(), endpoint);
  if (error) return refusal(error, socket_path);
  return out;
}

Result<Reply> Client::request(const std::string& method, const std::string& target,
                              const std::string& body, std::chrono::seconds timeout) {
  http::request<http::string_body> request(http::string_to_verb(method), target, kHttp11, body);
  request.set(http::field::host, "thimble");
  request.prepare_payload();
  http::response_parser<http::string_body> parser;
  parser.header_limit(kMaxHeaderBytes);
  parser.body_limit(kMaxBodyBytes);
  beast::error_code result = beast::error::timeout;
  stream_.expires_after(timeout);
  http::async_write(stream_, request, [&](beast::error_code error, std::size_t) {
    // A daemon that has too many clients answers before it is asked, and closes.
    static_cast<void>(error);
    http::async_read(stream_, buffer_, parser,
                     [&](beast::error_code read_error, std::size_t) { result = read_error; });
  });
  context_.restart();
  context_.run();
  stream_.expires_never();
  if (result) return failure(result);
  return Reply{parser.get().result_int(), std::move(parser.get().body())};
}

int Client::descriptor() { return stream_.socket().native_handle(); }

}  // namespace thimble::cli
