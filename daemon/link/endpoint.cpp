#include "daemon/link/endpoint.hpp"

#include <algorithm>
#include <boost/asio/ip/address_v4.hpp>
#include <boost/asio/ip/address_v6.hpp>
#include <charconv>

namespace thimble::link {
namespace {

constexpr std::string_view kScheme = "udp://";
constexpr std::size_t kMaxTextLength = 80;  // "udp://[" + 45 (longest IPv6) + "]:65535", with room
constexpr std::array<std::uint8_t, 12> kMappedPrefix{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF};

tl::unexpected<Error> malformed(std::string_view text) {
  const std::string shown(text.substr(0, kMaxTextLength));
  return fail(Errc::InvalidArgument,
              "'" + shown +
                  "' is not an endpoint: expected udp://ADDRESS:PORT with a numeric address, "
                  "[IPv6] in brackets, or localhost");
}

bool parse_port(std::string_view text, std::uint16_t& out) noexcept {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, out);
  return !text.empty() && error == std::errc{} && stop == end;
}

// Both parsers of Asio stop at the first NUL, and the second takes "%scope".
bool parse_address(const std::string& text, bool is_v6, Endpoint& out) {
  constexpr std::string_view kNotHere("\0%", 2);
  if (text.find_first_of(kNotHere) != std::string::npos) return false;
  boost::system::error_code error;
  out.is_v6 = is_v6;
  if (is_v6) {
    out.address = boost::asio::ip::make_address_v6(text, error).to_bytes();
    return !error;
  }
  const auto bytes = boost::asio::ip::make_address_v4(text, error).to_bytes();
  std::copy(bytes.begin(), bytes.end(), out.address.begin());
  return !error;
}

// RFC 4291, 2.5.5.2.
bool is_mapped(const Endpoint& endpoint) noexcept {
  return endpoint.is_v6 &&
         std::equal(kMappedPrefix.begin(), kMappedPrefix.end(), endpoint.address.begin());
}

// An IPv4 address in the form of IPv6, any other as it is.
std::array<std::uint8_t, 16> as_v6(const Endpoint& endpoint) noexcept {
  if (endpoint.is_v6) return endpoint.address;
  std::array<std::uint8_t, 16> out{};
  std::copy(kMappedPrefix.begin(), kMappedPrefix.end(), out.begin());
  std::copy_n(endpoint.address.begin(), 4, out.begin() + kMappedPrefix.size());
  return out;
}

std::string address_text(const Endpoint& endpoint) {
  if (endpoint.is_v6) {
    return "[" + boost::asio::ip::address_v6(endpoint.address).to_string() + "]";
  }
  boost::asio::ip::address_v4::bytes_type bytes{};
  std::copy_n(endpoint.address.begin(), bytes.size(), bytes.begin());
  return boost::asio::ip::address_v4(bytes).to_string();
}

}  // namespace

bool Endpoint::is_loopback() const noexcept {
  if (!is_v6) return address[0] == 127;
  if (is_mapped(*this)) return address[12] == 127;
  return address.back() == 1 &&
         std::all_of(address.begin(), address.end() - 1, [](std::uint8_t b) { return b == 0; });
}

bool Endpoint::has_same_address(const Endpoint& other) const noexcept {
  return as_v6(*this) == as_v6(other);
}

Result<Endpoint> parse_endpoint(std::string_view text) {
  if (text.size() > kMaxTextLength || text.substr(0, kScheme.size()) != kScheme) {
    return malformed(text);
  }
  const std::string_view rest = text.substr(kScheme.size());
  const std::size_t colon = rest.rfind(':');
  if (colon == std::string_view::npos) return malformed(text);
  std::string host(rest.substr(0, colon));
  Endpoint endpoint;
  if (!parse_port(rest.substr(colon + 1), endpoint.port)) return malformed(text);
  if (host == "localhost") host = "127.0.0.1";
  const bool is_bracketed = host.size() >= 2 && host.front() == '[' && host.back() == ']';
  if (is_bracketed) host = host.substr(1, host.size() - 2);
  if (!parse_address(host, is_bracketed, endpoint)) return malformed(text);
  return endpoint;
}

std::string to_string(const Endpoint& endpoint) {
  return std::string(kScheme) + address_text(endpoint) + ":" + std::to_string(endpoint.port);
}

Result<void> may_listen(const Endpoint& bind, bool allow_unauthenticated,
                        const std::optional<Endpoint>& pinned_peer) {
  if (bind.is_loopback()) return {};
  if (allow_unauthenticated && pinned_peer) return {};
  return fail(Errc::Permission,
              "refusing to listen on " + to_string(bind) +
                  ": beyond loopback it needs key_file, or for datagrams without a key "
                  "allow_unauthenticated = true and the address of the one peer");
}

Result<void> may_link(const Endpoint& peer, bool allow_unauthenticated) {
  if (peer.is_loopback() || allow_unauthenticated) return {};
  return fail(Errc::Permission, "refusing to link to " + to_string(peer) +
                                    ": beyond loopback it needs key_file, or for datagrams "
                                    "without a key allow_unauthenticated = true");
}

}  // namespace thimble::link
