#pragma once

#include <array>
#include <cstdint>

#include "daemon/coupling/arm_link.hpp"
#include "tests/campaign/dice.hpp"

namespace thimble::campaign {

// A link behind which somebody lies: sets with planes that are none (not finite, of no length,
// nowhere), surfaces without sense, more of them than a world would send, old sets again, sessions
// and numbers of nobody. No carriage of ours would let most of it through; the arm half and what
// comes after it must stand it all the same.
//
// Thread: as ArmLink. Ownership: the link below must outlive it.
class HostileLink final : public coupling::ArmLink {
 public:
  HostileLink(coupling::ArmLink& below, std::uint64_t seed) noexcept
      : below_(&below), dice_(seed) {}

  void send(const coupling::HandSample& sample) noexcept override;
  bool receive(coupling::ConstraintSet& out) noexcept override;
  [[nodiscard]] coupling::LinkQuality quality() const noexcept override {
    return below_->quality();
  }
  [[nodiscard]] std::uint64_t lies() const noexcept { return lies_; }

 private:
  void lie(coupling::ConstraintSet& set) noexcept;
  void invent_planes(coupling::ConstraintSet& set) noexcept;
  void renumber(coupling::ConstraintSet& set) noexcept;
  // Absurd one time in four, else within the range.
  [[nodiscard]] double some_number(double low, double high) noexcept;
  [[nodiscard]] Direction3 some_normal() noexcept;

  coupling::ArmLink* below_;
  Dice dice_;
  Position3 hand_{};
  std::array<coupling::ConstraintSet, 8> old_{};
  std::size_t kept_{0};
  std::uint64_t lies_{0};
};

}  // namespace thimble::campaign
