#include "lab/run/played_file.hpp"

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

std::vector<config::SerialEndpoint> listening_lines(const config::Config& config) {
  std::vector<config::SerialEndpoint> all;
  for (const config::WorldConfig& world : config.worlds) {
    if (world.line) all.push_back(*world.line);
  }
  for (const config::ArmConfig& arm : config.arms) {
    if (arm.listen_line) all.push_back(*arm.listen_line);
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

bool is_heard(const config::SerialEndpoint& link, std::size_t file,
              const std::vector<PlayedFile>& files) {
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (i == file) continue;
    for (const config::SerialEndpoint& one : listening_lines(files[i].config)) {
      if (one.node == link.node) return true;
    }
  }
  return false;
}

std::size_t ends_at(const std::string& node, const std::vector<PlayedFile>& files) {
  std::size_t ends = 0;
  for (const PlayedFile& file : files) {
    for (const config::SerialEndpoint& one : listening_lines(file.config)) {
      if (one.node == node) ++ends;
    }
    for (const config::ArmConfig& arm : file.config.arms) {
      if (arm.line && arm.line->node == node) ++ends;
    }
  }
  return ends;
}

bool is_heard(const config::UdpEndpoint& link, const std::vector<PlayedFile>& files) {
  for (const Listening& one : listening(files)) {
    if (one.port == link.port) return true;
  }
  return false;
}

}  // namespace thimble::lab
