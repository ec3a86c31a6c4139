#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/geometry.hpp"
#include "hal/base/time.hpp"
#include "sim/fault/fault_plan.hpp"

namespace thimble::campaign {

// What goes wrong, or what somebody does. The first are those of sim::FaultKind, in its
// order; while one lasts, every report of its direction suffers it.
enum class EventKind : std::uint8_t {
  DropIn,
  DropOut,
  DelayIn,
  DelayOut,
  CorruptIn,
  CorruptOut,
  TruncateIn,
  TruncateOut,
  Stall,
  Disconnect,   // the handle is dead; one opened after it is not
  RefuseOpen,   // somebody else holds the device
  LoseEvents,   // arrivals and departures are not told
  DelayEvents,  // they are told when it ends
  Unplug,       // the cable is out while it lasts
  Estop,        // the input is not healthy while it lasts
  DeadmanOpen,  // while it lasts
  Withdraw,     // nobody wants the arm active while it lasts
  Clear,        // of the fault that is latched then
  ClearOther,   // of another fault than that
  LateServo,    // one tick comes later by `lasts`
  NetworkDown,  // while it lasts
  Shove,        // somebody pushes the tip while it lasts
  FillCell,     // a cell of the world is filled while it lasts
  // Edits as a client of the API makes them; when one ends, its place is cleared and the walls of
  // the box stand again.
  EditFill,   // some cells, now and then all
  EditClear,  // some are freed
  EditBox,    // the outer layers of some
  EditPaint,  // those about a point
  EditAll,    // no cell is left free
  // Of an arm that is a bare USB device: sim::FaultKind again.
  Halt,
  Babble,
};
inline constexpr std::size_t kEventKindCount = 30;
[[nodiscard]] constexpr bool is_edit(EventKind kind) noexcept {
  return kind >= EventKind::EditFill && kind <= EventKind::EditAll;
}
// What the cable does meanwhile; none of what others do.
[[nodiscard]] std::optional<sim::FaultKind> fault_of(EventKind kind) noexcept;
[[nodiscard]] std::string_view to_string(EventKind kind) noexcept;

struct Event {
  EventKind kind{};
  Duration at{};  // since the episode's start
  Duration lasts{};
  std::uint64_t cell{0};  // FillCell and edits: which
  Force3 push{};          // Shove
  bool operator==(const Event&) const = default;
};

// The configuration of one episode: what differs from tests/data/hello.toml.
struct Setup {
  int rate_hz{1000};
  std::string_view device{"sim:phantom-vintage"};
  std::string_view motion{"explore"};
  std::uint64_t hand_seed{1};
  double hand_speed_m_per_s{0.15};
  double hand_reach_m{0.018};
  double hand_newton_per_m{200};
  std::string_view world{"box"};  // or "sphere", or "volume": of random labels
  int cells{3};                   // along an edge, where it has cells
  std::uint64_t world_seed{1};    // volume
  int materials{0};               // volume: the first so many labels have one each
  bool is_simple_model{false};
  bool is_thesis_literal{false};
  bool is_lock_step{false};
  double stiffness_newton_per_m{800};
  double force_newton{0};  // 0: the arm's own
  double rise_newton_per_s{1000};
  double amplifier_a{3};
  double newton_per_count{0};  // of a Falcon; 0: nobody measured it
  double ramp_s{0.5};
  bool is_realtime_required{false};
  bool is_edited{false};      // clients edit the world
  bool is_hostile{false};     // what answers the arm lies
  bool has_bystander{false};  // another arm, in the same world, to which nothing is done
  double delay_s{0};
  double jitter_s{0};
  double loss{0};
  double duplicate{0};
  double reorder{0};
  sim::RandomFaults noise{};  // of the cable
  bool operator==(const Setup&) const = default;

  // On HID otherwise.
  [[nodiscard]] bool is_bare_usb() const noexcept { return device.starts_with("sim:falcon"); }
};
// As --set takes them.
[[nodiscard]] std::vector<std::string> overrides(const Setup& setup);

// One episode, all of it: playing it twice is the same to the last bit.
struct Programme {
  std::uint64_t seed{0};
  std::uint64_t ticks{0};
  Setup setup;
  std::vector<Event> events;  // by time
};

// Episode number `episode` of the campaign that `seed` names.
[[nodiscard]] Programme draw(std::uint64_t seed, std::uint64_t episode);
// For a person: the configuration and one line an event.
[[nodiscard]] std::string to_text(const Programme& programme);
// What its cable suffers.
[[nodiscard]] sim::FaultPlan cables_of(const Programme& programme);

}  // namespace thimble::campaign
