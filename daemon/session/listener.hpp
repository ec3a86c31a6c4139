#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/config/config.hpp"
#include "daemon/link/link_counters.hpp"
#include "daemon/link/thimble_world_end.hpp"
#include "daemon/link/udp_world_server.hpp"
#include "daemon/session/arm_rig.hpp"
#include "hal/base/result.hpp"

namespace thimble::link {
class SerialWorldServer;
}

namespace thimble::session {

// Where arms of other hosts come: the socket or the serial line of a world, or of an arm that is
// another one's far end.
//
// Thread: the net plane's one thread. Ownership: what is behind the worlds must outlive it.
class Listener {
 public:
  // What a configuration says of it; of `listen` and `line` one is there.
  struct Said {
    std::optional<config::UdpEndpoint> listen{};
    std::optional<config::SerialEndpoint> line{};
    bool allow_unauthenticated{false};
    std::optional<std::string> peer{};
    std::optional<std::string> key_file{};
    std::optional<config::ImpairmentConfig> impairment{};
  };
  // `end`: what is told, and of how many; the rest of it is as said. Errors: Unsupported where
  // `parts` has no way here, the key file's, or the address cannot be bound.
  [[nodiscard]] static Result<std::unique_ptr<Listener>> open(
      const Said& said, link::ThimbleWorldEnd::Settings end,
      const link::UdpWorldServer::Worlds& worlds, const RigParts& parts);
  ~Listener();

  [[nodiscard]] bool has_line() const noexcept { return line_ != nullptr; }
  // The socket's, with the port that was given for 0; nothing of a line.
  [[nodiscard]] link::Endpoint local() const;
  [[nodiscard]] link::LinkStatus status() const;
  // Of each session of our own datagrams; they count in status(), too.
  [[nodiscard]] std::vector<link::LinkStatus> sessions() const;

 private:
  Listener();

  // Of the two one.
  std::unique_ptr<link::UdpWorldServer> server_;
  std::unique_ptr<link::SerialWorldServer> line_;
};

}  // namespace thimble::session
