#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "daemon/coupling/arm_link.hpp"
#include "daemon/link/arm_mailbox.hpp"
#include "daemon/link/link_counters.hpp"
#include "daemon/link/thimble_arm_end.hpp"
#include "daemon/link/thimble_world_end.hpp"
#include "hal/base/time.hpp"

namespace thimble::lab {

// Both ends of the daemon's own datagrams (docs/link-protocol.md) in virtual time: what one sends
// the other has at once, every byte of it; delays and losses are those that the ends inject. To be
// used as link::InProcessLink, whose timing it has once the session stands.
//
// Thread: one. Ownership: what is behind the halves must outlive it. Errors: none; the settings
// must be valid. Deterministic by seed.
class DatagramLink {
 public:
  struct Settings {
    link::ThimbleArmEnd::Settings arm{};
    link::ThimbleWorldEnd::Settings world{};
    std::uint64_t seed{1};
  };
  DatagramLink(const Settings& settings, link::ThimbleWorldEnd::MakeHalf make_half);

  [[nodiscard]] coupling::ArmLink& arm_end() noexcept { return mailbox_; }
  // Moves everything that is due. Returns when to come again at the latest.
  std::optional<MonotonicTime> pump(MonotonicTime now);
  // The program at the arm's end has ended; another one begins, at a port of its own.
  void restart_arm(const link::ThimbleArmEnd::Settings& settings);
  [[nodiscard]] link::LinkStatus status() const { return arm_->status(); }
  [[nodiscard]] const link::ThimbleWorldEnd& world() const noexcept { return world_; }
  // What somebody else sends to the world's end.
  void send_to_world(std::span<const std::byte> bytes, MonotonicTime now);
  // Sees every datagram that an arm sends.
  std::function<void(const link::ThimbleDatagram&)> on_sent{};

 private:
  bool carry(MonotonicTime now);

  link::RandomBytes random_;
  link::ArmMailbox mailbox_{nullptr};
  link::Endpoint place_{};
  std::unique_ptr<link::ThimbleArmEnd> arm_;
  link::ThimbleWorldEnd world_;
};

}  // namespace thimble::lab
