#include <array>

#include "daemon/config/endpoint.hpp"
#include "daemon/config/schema.hpp"

namespace thimble::config {
namespace {

// Beyond it a number is a slip of the pen, not a wish.
constexpr Range kDeadband{0, 0.005};

constexpr std::array<Choice<LinkProtocol>, 2> kProtocols{{
    {"thesis", LinkProtocol::Thesis},
    {"thimble", LinkProtocol::Thimble},
}};

void read_endpoint(TableReader& reader, std::string_view key, std::uint16_t min_port,
                   std::optional<UdpEndpoint>& out, std::optional<SerialEndpoint>& line) {
  std::string text;
  if (!reader.read(key, text)) return;
  line = parse_line(text);
  if (line) return;
  auto endpoint = parse_endpoint(text);
  if (!endpoint || endpoint->port < min_port) {
    return reader.reject(key,
                         "expected a numeric address such as \"udp://127.0.0.1:5001\", or a "
                         "line of 38400 to 3000000 bit/s such as \"serial:/dev/ttyS0@115200\", "
                         "found " +
                             in_quotes(text));
  }
  out = std::move(endpoint);
}

// Where others come, whoever has it.
struct Listening {
  const std::optional<UdpEndpoint>& listen;
  const std::optional<SerialEndpoint>& line;
  const bool& allow_unauthenticated;
  const std::optional<std::string>& peer;
  const std::optional<std::string>& key_file;
};

void check_listening(TableReader& reader, const Listening& out) {
  if (out.peer && !is_address(*out.peer)) {
    reader.reject("peer",
                  "expected a numeric address such as \"10.0.0.2\", found " + in_quotes(*out.peer));
  } else if (out.peer && out.listen && !can_hear(out.listen->address, *out.peer)) {
    reader.reject("peer", "expected an address that can reach " +
                              in_quotes(to_string(*out.listen)) + ", which is of the other " +
                              "kind (IPv4, IPv6), found " + in_quotes(*out.peer));
  }
  for (const char* key : {"allow_unauthenticated", "peer"}) {
    if (out.line && reader.has(key)) {
      reader.reject(key, "expected only beside an address, found beside a line");
    }
  }
  if (!out.listen || is_loopback(out.listen->address)) return;
  if (out.key_file || (out.allow_unauthenticated && out.peer)) return;
  reader.reject("listen",
                "expected a loopback address, or a key_file, or allow_unauthenticated = true and a "
                "peer for datagrams without a key; found " +
                    in_quotes(to_string(*out.listen)));
}

void check_link(TableReader& reader, const ArmConfig& arm) {
  if (arm.key_file && arm.protocol == LinkProtocol::Thesis) {
    reader.reject("key_file",
                  "expected only with protocol = \"thimble\": the datagrams of 1999 know no key");
  }
  if (arm.line && reader.has("allow_unauthenticated")) {
    reader.reject("allow_unauthenticated", "expected only beside an address, found beside a line");
  }
  if (!arm.link || is_loopback(arm.link->address)) return;
  if (arm.allow_unauthenticated || arm.key_file) return;
  reader.reject("link",
                "expected a loopback address, or protocol = \"thimble\" and a key_file, or "
                "allow_unauthenticated = true for datagrams without a key; found " +
                    in_quotes(to_string(*arm.link)));
}

// The far end is one thing: a world, here or behind a link, or an arm, here or wherever it comes
// from.
void check_far_end(TableReader& reader) {
  const bool has_world = reader.has("world");
  const bool has_link = reader.has("link");
  if (has_world && has_link) {
    reader.reject("link", "expected either world or link, found both");
  }
  // Beside listen a peer is an address.
  const char* const arm_key = reader.has("listen") ? "listen" : "peer";
  const bool has_arm = reader.has(arm_key);
  if (has_arm && (has_world || has_link)) {
    reader.reject(arm_key, "expected neither world nor link beside it, found " +
                               in_quotes(has_world ? "world" : "link"));
  }
  if (!has_world && !has_link && !has_arm) {
    reader.reject("", "expected either world or link, found neither");
  }
}

}  // namespace

void read_other_side(TableReader& reader, const std::filesystem::path& folder, ArmConfig& arm) {
  reader.read("world", arm.world);
  read_endpoint(reader, "link", 1, arm.link, arm.line);
  read_endpoint(reader, "listen", 0, arm.listen, arm.listen_line);
  reader.read("peer", arm.peer);
  reader.read("protocol", std::span<const Choice<LinkProtocol>>(kProtocols), arm.protocol);
  reader.read("allow_unauthenticated", arm.allow_unauthenticated);
  read_path(reader, "key_file", folder, arm.key_file);
  reader.read("deadband_m", kDeadband, arm.deadband_m);
  check_far_end(reader);
  for (const char* key : {"protocol", "deadband_m"}) {
    if (reader.has(key) && !reader.has("link")) {
      reader.reject(key, "expected only beside link, found without it");
    }
  }
  for (const char* key : {"allow_unauthenticated", "key_file"}) {
    if (reader.has(key) && !reader.has("link") && !reader.has("listen")) {
      reader.reject(key, "expected only beside link or listen, found without either");
    }
  }
  if (reader.has("link")) check_link(reader, arm);
  if (!reader.has("listen")) return;
  arm.peer_address.swap(arm.peer);
  check_listening(reader, {arm.listen, arm.listen_line, arm.allow_unauthenticated, arm.peer_address,
                           arm.key_file});
}

void read_listener(TableReader& reader, const std::filesystem::path& folder, WorldConfig& world) {
  read_endpoint(reader, "listen", 0, world.listen, world.line);
  reader.read("allow_unauthenticated", world.allow_unauthenticated);
  reader.read("peer", world.peer);
  read_path(reader, "key_file", folder, world.key_file);
  check_listening(
      reader, {world.listen, world.line, world.allow_unauthenticated, world.peer, world.key_file});
  for (const char* key : {"allow_unauthenticated", "peer", "key_file"}) {
    if (reader.has(key) && !reader.has("listen")) {
      reader.reject(key, "expected only beside listen, found without it");
    }
  }
}

}  // namespace thimble::config
