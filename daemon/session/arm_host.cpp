#include "daemon/session/arm_host.hpp"

#include <utility>

#include "daemon/config/peers.hpp"
#include "daemon/session/arm_settings.hpp"

namespace thimble::session {

coupling::PeerAnswer answer_for(config::CouplingScheme scheme) {
  return scheme_of(scheme) == coupling::Scheme::GhostPoint ? coupling::PeerAnswer::Touch
                                                           : coupling::PeerAnswer::Motion;
}

ArmHost::ArmHost(const config::ArmConfig& arm, std::uint32_t first_session)
    : name_(arm.name), scheme_(arm.coupling.scheme), pair_(first_session) {}

Result<std::unique_ptr<ArmHost>> ArmHost::create(const config::ArmConfig& arm,
                                                 const RigParts& parts) {
  // The constructor is private, so make_unique cannot reach it.
  std::unique_ptr<ArmHost> host(new ArmHost(arm, parts.first_session));
  link::ThimbleWorldEnd::Settings end;
  end.max_sessions = 1;
  end.welcome.world = link::ShortName::of(arm.name);
  end.arm_scheme = half_of(arm.coupling).scheme;
  link::UdpWorldServer::Worlds worlds;
  worlds.make_half = [self = host.get()](const link::ThimbleHalf& half) {
    return self->make_guest_half(half);
  };
  auto listener = Listener::open({arm.listen, arm.listen_line, arm.allow_unauthenticated,
                                  arm.peer_address, arm.key_file, arm.impairment},
                                 end, worlds, parts);
  if (!listener) return tl::unexpected(listener.error().in("arm '" + arm.name + "'"));
  host->listener_ = *std::move(listener);
  return host;
}

std::unique_ptr<coupling::WorldCoupling> ArmHost::make_half() const {
  return pair_.make_half(coupling::ArmPair::Side::First, answer_for(scheme_));
}

Result<std::unique_ptr<coupling::WorldCoupling>> ArmHost::make_guest_half(
    const link::ThimbleHalf& half) const {
  const Result<config::CouplingConfig> guest = coupling_of(half);
  if (!guest) return tl::unexpected(guest.error());
  if (!config::are_peers(scheme_, guest->scheme)) {
    return fail(Errc::Unsupported, "its scheme " + std::string(half.scheme.view()) +
                                       " does not go with " +
                                       std::string(to_string(scheme_of(scheme_))) + " here");
  }
  return pair_.make_half(coupling::ArmPair::Side::Second, answer_for(guest->scheme));
}

std::string ArmHost::guest() const {
  for (const link::LinkStatus& session : listener_->sessions()) return session.peer;
  return "";
}

}  // namespace thimble::session
