#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "hal/device/fault.hpp"
#include "hal/device/operating_state.hpp"
#include "sim/fault/faulty_hid.hpp"
#include "tests/campaign/invariant.hpp"
#include "tests/campaign/programme.hpp"

namespace thimble::campaign {

// What happened, in numbers; those of several episodes add up.
struct Tally {
  std::uint64_t episodes{0};
  std::uint64_t ticks{0};
  double played_s{0};  // on the arms' clocks
  std::array<std::uint64_t, kEventKindCount> events{};
  sim::FaultCounts reports{};  // of single reports, by kind
  std::uint64_t messages_lost{0};
  std::uint64_t messages_duplicated{0};
  std::uint64_t messages_reordered{0};
  std::array<std::uint64_t, kOperatingStateCount> ticks_in{};
  std::array<std::uint64_t, kFaultCodeCount> latched{};
  std::uint64_t cleared{0};
  std::uint64_t unplugged{0};   // Active or not, to Lost
  std::uint64_t recoveries{0};  // driven again after a fault or a loss
  std::uint64_t recoveries_on_usb{0};
  std::uint64_t edits{0};  // applied
  std::uint64_t contacts{0};
  std::uint64_t lies{0};  // sets that a hostile world sent
  // Episodes that were another thing than one arm in a box.
  std::uint64_t in_spheres{0};
  std::uint64_t in_volumes{0};
  std::uint64_t with_bystander{0};
  std::uint64_t on_bare_usb{0};
  Judged judged{};  // of its touches that ended
  double peak_newton{0};

  void add(const Tally& other) noexcept;
};

struct Ending {
  std::optional<Breach> breach;  // the first; the episode ends there
  std::uint64_t trace{0};        // of every tick: the same programme gives the same
  Tally tally;
};

// What a test may put in place of the real thing, to see the campaign find it.
struct Planted {
  std::vector<plugin::SimModelEntry> models{};  // empty: tapped_arms(), and others
  std::function<std::vector<std::unique_ptr<Invariant>>(const Bounds&)> invariants{};
};

// Plays a programme in virtual time: the real driver, servo, coupling, link and world on a
// simulated bus, with a hand that explores; every tick is judged.
[[nodiscard]] Ending play(const Programme& programme, const Planted& planted = {});

}  // namespace thimble::campaign
