#include "daemon/link/udp_arm_link.hpp"
#include "daemon/session/arm_settings.hpp"
#include "daemon/session/rig_link.hpp"

namespace thimble::session {
namespace {

class UdpRigLink final : public RigLink {
 public:
  explicit UdpRigLink(std::unique_ptr<link::UdpArmLink> link) : link_(std::move(link)) {}

  [[nodiscard]] coupling::ArmLink& arm_end() noexcept override { return link_->arm_end(); }
  // The link has timers of its own on the network: only a wake brings work from outside.
  std::optional<MonotonicTime> pump(MonotonicTime) override {
    link_->on_wake();
    return std::nullopt;
  }
  [[nodiscard]] link::LinkStatus status() const override { return link_->status(); }

 private:
  std::unique_ptr<link::UdpArmLink> link_;
};

}  // namespace

Result<std::unique_ptr<RigLink>> make_udp_link(const config::ArmConfig& arm,
                                               link::DatagramNetwork& network, const Clock& clock,
                                               rt::WakeSignal* wake) {
  if (!arm.link) return fail(Errc::InvalidArgument, "arm.link is not set");
  const Result<link::Endpoint> peer = endpoint(*arm.link);
  if (!peer) return tl::unexpected(peer.error());
  link::UdpArmLink::Settings settings;
  settings.peer = *peer;
  settings.allow_unauthenticated = arm.allow_unauthenticated;
  const Result<link::ArmEndSettings> end = arm_end_settings(arm);
  if (!end) return tl::unexpected(end.error());
  settings.end = *end;
  Result<std::unique_ptr<link::UdpArmLink>> link =
      link::UdpArmLink::open(network, clock, settings, wake);
  if (!link) return tl::unexpected(link.error());
  return std::make_unique<UdpRigLink>(*std::move(link));
}

}  // namespace thimble::session
