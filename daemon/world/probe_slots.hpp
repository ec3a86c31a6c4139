#pragma once

#include <array>
#include <optional>
#include <string>

#include "daemon/world/world.hpp"

namespace thimble::world {

// The probes of one world, each with its ghost.
// Thread: the world's. Not RT; find() and remove() neither allocate nor block.
template <class Ghost>
class ProbeSlots {
 public:
  // Busy, in the name of `source`, when all kMaxProbes are taken.
  [[nodiscard]] Result<ProbeId> add(const Ghost& ghost, const std::string& source) {
    for (auto& slot : slots_) {
      if (slot) continue;
      slot = Slot{{++last_id_}, ghost};
      return slot->id;
    }
    return fail(Errc::Busy,
                source + ": all " + std::to_string(kMaxProbes) + " probes of the world are taken");
  }
  void remove(ProbeId id) noexcept {
    for (auto& slot : slots_) {
      if (slot && slot->id == id) slot.reset();
    }
  }
  // nullptr: there is none of that name.
  [[nodiscard]] Ghost* find(ProbeId id) noexcept {
    for (auto& slot : slots_) {
      if (slot && slot->id == id) return &slot->ghost;
    }
    return nullptr;
  }

 private:
  struct Slot {
    ProbeId id{};
    Ghost ghost{};
  };
  std::array<std::optional<Slot>, kMaxProbes> slots_{};
  std::uint32_t last_id_{0};
};

}  // namespace thimble::world
