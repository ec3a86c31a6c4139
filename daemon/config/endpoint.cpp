#include "daemon/config/endpoint.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <charconv>

namespace thimble::config {
namespace {

constexpr std::string_view kScheme = "udp://";
constexpr std::string_view kLine = "serial:";
// termios(3) has no others in this range.
constexpr std::array<std::uint32_t, 14> kRates_bit_per_s{
    38'400,  57'600,    115'200,   230'400,   460'800,   500'000,   576'000,
    921'600, 1'000'000, 1'152'000, 1'500'000, 2'000'000, 2'500'000, 3'000'000};

std::optional<in_addr> as_v4(const std::string& text) {
  in_addr address{};
  if (inet_pton(AF_INET, text.c_str(), &address) != 1) return std::nullopt;
  return address;
}

std::optional<in6_addr> as_v6(const std::string& text) {
  in6_addr address{};
  if (inet_pton(AF_INET6, text.c_str(), &address) != 1) return std::nullopt;
  return address;
}

std::optional<std::uint16_t> parse_port(std::string_view text) {
  std::uint16_t port = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return port;
}

std::optional<std::uint32_t> parse_rate(std::string_view text) {
  std::uint32_t rate = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), rate);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  const bool is_known =
      std::find(kRates_bit_per_s.begin(), kRates_bit_per_s.end(), rate) != kRates_bit_per_s.end();
  return is_known ? std::optional(rate) : std::nullopt;
}

bool is_v4_in_any_form(const std::string& address) {
  if (as_v4(address)) return true;
  const auto v6 = as_v6(address);
  return v6 && IN6_IS_ADDR_V4MAPPED(&*v6) != 0;
}

}  // namespace

std::optional<UdpEndpoint> parse_endpoint(std::string_view text) {
  if (!text.starts_with(kScheme)) return std::nullopt;
  text.remove_prefix(kScheme.size());
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) return std::nullopt;
  const auto port = parse_port(text.substr(colon + 1));
  if (!port) return std::nullopt;
  std::string_view host = text.substr(0, colon);
  const bool is_bracketed = host.size() > 2 && host.front() == '[' && host.back() == ']';
  if (is_bracketed) host = host.substr(1, host.size() - 2);
  std::string address(host);
  const bool is_good = is_bracketed ? as_v6(address).has_value() : as_v4(address).has_value();
  if (!is_good || address.find('\0') != std::string::npos) return std::nullopt;
  return UdpEndpoint{std::move(address), *port};
}

std::optional<SerialEndpoint> parse_line(std::string_view text) {
  if (!text.starts_with(kLine)) return std::nullopt;
  text.remove_prefix(kLine.size());
  const std::size_t at = text.rfind('@');
  if (at == std::string_view::npos || !text.starts_with('/')) return std::nullopt;
  const auto rate = parse_rate(text.substr(at + 1));
  std::string node(text.substr(0, at));
  if (!rate || node.find('\0') != std::string::npos) return std::nullopt;
  return SerialEndpoint{std::move(node), *rate};
}

std::string to_string(const SerialEndpoint& line) {
  return std::string(kLine) + line.node + "@" + std::to_string(line.bit_per_s);
}

std::string to_string(const UdpEndpoint& endpoint) {
  const bool is_v6 = endpoint.address.find(':') != std::string::npos;
  const std::string host = is_v6 ? "[" + endpoint.address + "]" : endpoint.address;
  return std::string(kScheme) + host + ":" + std::to_string(endpoint.port);
}

bool is_address(const std::string& text) { return as_v4(text) || as_v6(text); }

bool is_loopback(const std::string& address) {
  // RFC 1122, 3.2.1.3: 127.0.0.0/8. RFC 4291, 2.5.3: ::1.
  if (const auto v4 = as_v4(address)) return (ntohl(v4->s_addr) >> 24U) == 127;
  const auto v6 = as_v6(address);
  return v6 && IN6_IS_ADDR_LOOPBACK(&*v6) != 0;
}

bool can_hear(const std::string& listen, const std::string& peer) {
  const auto v6 = as_v6(listen);
  if (v6 && IN6_IS_ADDR_UNSPECIFIED(&*v6) != 0) return true;
  return is_v4_in_any_form(listen) == is_v4_in_any_form(peer);
}

}  // namespace thimble::config
