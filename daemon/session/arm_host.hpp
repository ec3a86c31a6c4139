#pragma once

#include <memory>
#include <string>
#include <vector>

#include "daemon/config/config.hpp"
#include "daemon/coupling/arm_pair.hpp"
#include "daemon/coupling/world_coupling.hpp"
#include "daemon/link/link_counters.hpp"
#include "daemon/session/arm_rig.hpp"
#include "daemon/session/listener.hpp"
#include "hal/base/result.hpp"

namespace thimble::session {

// An arm of the configuration that listens (`arm.listen`): the arm of another host is its far end,
// one at a time. Whatever becomes of the arm itself, the address is kept.
//
// Thread: the net plane's one thread. Ownership: the links of the arm may outlive it.
class ArmHost {
 public:
  // Errors: as Listener::open(), named by arm.
  [[nodiscard]] static Result<std::unique_ptr<ArmHost>> create(const config::ArmConfig& arm,
                                                               const RigParts& parts);

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  // What answers the arm of this host: what the other one said last.
  [[nodiscard]] std::unique_ptr<coupling::WorldCoupling> make_half() const;
  [[nodiscard]] const Listener& listener() const noexcept { return *listener_; }
  // Where the other arm is; empty: there is none.
  [[nodiscard]] std::string guest() const;

 private:
  ArmHost(const config::ArmConfig& arm, std::uint32_t first_session);
  // Errors: Unsupported, an arm with such a scheme does not go with this one.
  [[nodiscard]] Result<std::unique_ptr<coupling::WorldCoupling>> make_guest_half(
      const link::ThimbleHalf& half) const;

  std::string name_;
  config::CouplingScheme scheme_;
  coupling::ArmPair pair_;
  std::unique_ptr<Listener> listener_;  // last: it uses the rest
};

// What an arm of that scheme is told of its peer.
[[nodiscard]] coupling::PeerAnswer answer_for(config::CouplingScheme scheme);

}  // namespace thimble::session
