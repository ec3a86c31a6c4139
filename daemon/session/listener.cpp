#include "daemon/session/listener.hpp"

#include <utility>

#include "daemon/link/serial_world_server.hpp"
#include "daemon/session/arm_settings.hpp"

namespace thimble::session {
namespace {

Result<link::UdpWorldServer::Settings> socket_settings(const Listener::Said& said,
                                                       const link::ThimbleWorldEnd::Settings& end) {
  link::UdpWorldServer::Settings settings;
  const Result<link::Endpoint> bind = endpoint(*said.listen);
  if (!bind) return tl::unexpected(bind.error());
  settings.bind = *bind;
  settings.allow_unauthenticated = said.allow_unauthenticated;
  settings.end = end;
  if (!said.peer) return settings;
  const Result<link::Endpoint> peer = endpoint({*said.peer, 0});
  if (!peer) return tl::unexpected(peer.error());
  settings.end.pinned_peer = *peer;
  return settings;
}

}  // namespace

Listener::Listener() = default;
Listener::~Listener() = default;

Result<std::unique_ptr<Listener>> Listener::open(const Said& said,
                                                 link::ThimbleWorldEnd::Settings end,
                                                 const link::UdpWorldServer::Worlds& worlds,
                                                 const RigParts& parts) {
  end.impairment = impairment_settings(said.impairment);
  if (said.key_file) {
    const Result<link::LinkKey> key = link::load_key(*said.key_file);
    if (!key) return tl::unexpected(key.error());
    end.key = *key;
  }
  // The constructor is private, so make_unique cannot reach it.
  std::unique_ptr<Listener> listener(new Listener());
  const Clock* const clock = network_clock(parts);
  if (said.line) {
    if (parts.lines == nullptr || clock == nullptr) {
      return fail(Errc::Unsupported, "line: this program has no serial ports for arms to come by");
    }
    listener->line_ = std::make_unique<link::SerialWorldServer>(
        *parts.lines, *clock, link::SerialWorldServer::Settings{serial_line(*said.line), end},
        worlds);
    return listener;
  }
  if (parts.network == nullptr || clock == nullptr) {
    return fail(Errc::Unsupported,
                "listen: there is no network for arms of other hosts to come by");
  }
  const auto settings = socket_settings(said, end);
  if (!settings) return tl::unexpected(settings.error());
  auto server = link::UdpWorldServer::open(*parts.network, *clock, *settings, worlds);
  if (!server) return tl::unexpected(server.error());
  listener->server_ = *std::move(server);
  return listener;
}

link::Endpoint Listener::local() const { return server_ ? server_->local() : link::Endpoint{}; }

link::LinkStatus Listener::status() const { return line_ ? line_->status() : server_->status(); }

std::vector<link::LinkStatus> Listener::sessions() const {
  return line_ ? line_->sessions() : server_->sessions();
}

}  // namespace thimble::session
