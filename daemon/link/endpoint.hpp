#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "hal/base/result.hpp"

namespace thimble::link {

// A UDP address and port, numeric; also the identity of a peer. All here: any thread, pure, not RT.
struct Endpoint {
  std::array<std::uint8_t, 16> address{};  // IPv4: the first four, the rest zero
  bool is_v6{false};
  std::uint16_t port{0};
  std::uint32_t scope{0};  // of a link-local IPv6 peer that wrote to us; not parsed

  bool operator==(const Endpoint&) const = default;
  [[nodiscard]] bool is_loopback() const noexcept;  // 127.0.0.0/8, ::1, ::ffff:127.0.0.0/104
  // Whatever the ports, and whether an IPv4 address is written as such or as ::ffff:a.b.c.d: so a
  // socket that listens on [::] gives the senders of both families.
  [[nodiscard]] bool has_same_address(const Endpoint& other) const noexcept;
};

// "udp://127.0.0.1:5001", "udp://[::1]:5001", "udp://localhost:5001" (which is 127.0.0.1).
// Names are not resolved: a resolver may block for seconds and answer differently tomorrow.
// Port 0 is taken: a listener then gets a free one. Total.
// Errors: InvalidArgument in one sentence that names what was expected.
[[nodiscard]] Result<Endpoint> parse_endpoint(std::string_view text);
// As parse_endpoint() takes it.
[[nodiscard]] std::string to_string(const Endpoint& endpoint);

// Whether a listener for datagrams without a key may bind there: loopback
// always; elsewhere only when the configuration says so and pins the peer's address (DESIGN
// section 3). Errors: Permission, in one sentence.
[[nodiscard]] Result<void> may_listen(const Endpoint& bind, bool allow_unauthenticated,
                                      const std::optional<Endpoint>& pinned_peer);
// The same for an arm's end, whose one peer is pinned anyhow: who can forge the address of the
// world tells the arm of walls. Errors: Permission, in one sentence.
[[nodiscard]] Result<void> may_link(const Endpoint& peer, bool allow_unauthenticated);

}  // namespace thimble::link
