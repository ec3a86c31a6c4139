#include "hal/device/operating_state.hpp"

namespace thimble {
namespace {

using S = OperatingState;
using E = LifecycleEvent;

struct Transition {
  S from;
  E event;
  S to;
};

// Not in the table: Fail is legal wherever a device is open, Unplug from everywhere but Lost;
// see next_state().
constexpr std::array kTransitions{
    Transition{S::Discovered, E::Open, S::Opened},
    Transition{S::Opened, E::Configure, S::Configured},
    Transition{S::Configured, E::Calibrate, S::Calibrating},
    Transition{S::Calibrating, E::Homed, S::Inactive},
    Transition{S::Inactive, E::Activate, S::Active},
    Transition{S::Inactive, E::LoseHome, S::Calibrating},
    Transition{S::Active, E::Deactivate, S::Inactive},
    Transition{S::Fault, E::ClearFault, S::Configured},
    Transition{S::Fault, E::LoseHome, S::Calibrating},  // the latch stays, and leads back to Fault
    Transition{S::Lost, E::Return, S::Discovered},
    Transition{S::Opened, E::Close, S::Discovered},
    Transition{S::Configured, E::Close, S::Discovered},
    Transition{S::Calibrating, E::Close, S::Discovered},
    Transition{S::Inactive, E::Close, S::Discovered},
    Transition{S::Fault, E::Close, S::Discovered},
};

}  // namespace

std::optional<OperatingState> next_state(OperatingState state, LifecycleEvent event) noexcept {
  if (event == E::Unplug) return state == S::Lost ? std::nullopt : std::optional(S::Lost);
  if (event == E::Fail) {
    const bool has_device = state != S::Discovered && state != S::Lost && state != S::Fault;
    return has_device ? std::optional(S::Fault) : std::nullopt;
  }
  for (const Transition& t : kTransitions) {
    if (t.from == state && t.event == event) return t.to;
  }
  return std::nullopt;
}

std::string_view to_string(OperatingState state) noexcept {
  switch (state) {
    case S::Discovered:
      return "discovered";
    case S::Opened:
      return "opened";
    case S::Configured:
      return "configured";
    case S::Calibrating:
      return "calibrating";
    case S::Inactive:
      return "inactive";
    case S::Active:
      return "active";
    case S::Fault:
      return "fault";
    case S::Lost:
      return "lost";
  }
  return "unknown";
}

std::string_view to_string(LifecycleEvent event) noexcept {
  switch (event) {
    case E::Open:
      return "open";
    case E::Configure:
      return "configure";
    case E::Calibrate:
      return "calibrate";
    case E::Homed:
      return "homed";
    case E::Activate:
      return "activate";
    case E::Deactivate:
      return "deactivate";
    case E::LoseHome:
      return "lose-home";
    case E::Fail:
      return "fail";
    case E::ClearFault:
      return "clear-fault";
    case E::Unplug:
      return "unplug";
    case E::Return:
      return "return";
    case E::Close:
      return "close";
  }
  return "unknown";
}

}  // namespace thimble
