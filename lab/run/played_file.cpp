#include "lab/run/played_file.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>

#include "daemon/config/endpoint.hpp"

namespace thimble::lab {
namespace {

// A port that a file listens on, and the one address that it answers there.
struct Listening {
  std::size_t file{0};
  std::uint16_t port{0};
  std::optional<std::string> pinned{};
};

std::vector<Listening> listening(const std::vector<PlayedFile>& files) {
  std::vector<Listening> all;
  for (std::size_t i = 0; i < files.size(); ++i) {
    for (const config::WorldConfig& world : files[i].config.worlds) {
      if (world.listen) all.push_back({i, world.listen->port, world.peer});
    }
    for (const config::ArmConfig& arm : files[i].config.arms) {
      if (arm.listen) all.push_back({i, arm.listen->port, arm.peer_address});
    }
  }
  return all;
}

std::optional<link::Endpoint> parsed(const std::string& address) {
  const auto endpoint = link::parse_endpoint(config::to_string(config::UdpEndpoint{address, 0}));
  return endpoint ? std::optional(*endpoint) : std::nullopt;
}

}  // namespace

std::vector<link::Endpoint> host_addresses(const std::vector<PlayedFile>& files) {
  std::vector<std::optional<link::Endpoint>> linked(files.size());
  std::vector<std::optional<link::Endpoint>> pinned(files.size());
  const std::vector<Listening> all = listening(files);
  for (std::size_t i = 0; i < files.size(); ++i) {
    for (const config::ArmConfig& arm : files[i].config.arms) {
      if (!arm.link) continue;
      for (const Listening& one : all) {
        if (one.port != arm.link->port) continue;
        if (one.pinned) pinned[i] = parsed(*one.pinned);
        linked[one.file] = parsed(arm.link->address);
      }
    }
  }
  const link::Endpoint loopback{.address = {127, 0, 0, 1}};
  std::vector<link::Endpoint> addresses;
  for (std::size_t i = 0; i < files.size(); ++i) {
    addresses.push_back(pinned[i] ? *pinned[i] : linked[i].value_or(loopback));
  }
  return addresses;
}

bool is_heard(const config::UdpEndpoint& link, const std::vector<PlayedFile>& files) {
  for (const Listening& one : listening(files)) {
    if (one.port == link.port) return true;
  }
  return false;
}

}  // namespace thimble::lab
