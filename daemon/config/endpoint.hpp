#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "daemon/config/config.hpp"

namespace thimble::config {

// "udp://127.0.0.1:5001", "udp://[::1]:5001". Nothing for anything else. Total.
[[nodiscard]] std::optional<UdpEndpoint> parse_endpoint(std::string_view text);
[[nodiscard]] std::string to_string(const UdpEndpoint& endpoint);

// "serial:/dev/ttyS0@115200": an absolute path, and a rate of those that lines of 38,400 to
// 3,000,000 bit/s have. Nothing for anything else. Total.
[[nodiscard]] std::optional<SerialEndpoint> parse_line(std::string_view text);
[[nodiscard]] std::string to_string(const SerialEndpoint& line);

// A numeric IPv4 or IPv6 address.
[[nodiscard]] bool is_address(const std::string& text);
// An address that only this machine can reach.
[[nodiscard]] bool is_loopback(const std::string& address);
// Whether datagrams of `peer` can arrive at a socket bound to `listen`, both addresses: the
// families must be the same, but "::" hears both. "::ffff:1.2.3.4" is an IPv4 address.
[[nodiscard]] bool can_hear(const std::string& listen, const std::string& peer);

}  // namespace thimble::config
