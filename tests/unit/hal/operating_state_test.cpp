#include "hal/device/operating_state.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <utility>

namespace thimble {
namespace {

using S = OperatingState;
using E = LifecycleEvent;

// The oracle is written out by hand from the design's sentence, not from the table.
const std::map<std::pair<S, E>, S> kLegal{
    {{S::Discovered, E::Open}, S::Opened},
    {{S::Opened, E::Configure}, S::Configured},
    {{S::Configured, E::Calibrate}, S::Calibrating},
    {{S::Calibrating, E::Homed}, S::Inactive},
    {{S::Inactive, E::Activate}, S::Active},
    {{S::Active, E::Deactivate}, S::Inactive},
    {{S::Inactive, E::LoseHome}, S::Calibrating},
    {{S::Fault, E::ClearFault}, S::Configured},
    {{S::Fault, E::LoseHome}, S::Calibrating},
    {{S::Lost, E::Return}, S::Discovered},
    {{S::Opened, E::Close}, S::Discovered},
    {{S::Configured, E::Close}, S::Discovered},
    {{S::Calibrating, E::Close}, S::Discovered},
    {{S::Inactive, E::Close}, S::Discovered},
    {{S::Fault, E::Close}, S::Discovered},
    {{S::Opened, E::Fail}, S::Fault},
    {{S::Configured, E::Fail}, S::Fault},
    {{S::Calibrating, E::Fail}, S::Fault},
    {{S::Inactive, E::Fail}, S::Fault},
    {{S::Active, E::Fail}, S::Fault},
    {{S::Discovered, E::Unplug}, S::Lost},
    {{S::Opened, E::Unplug}, S::Lost},
    {{S::Configured, E::Unplug}, S::Lost},
    {{S::Calibrating, E::Unplug}, S::Lost},
    {{S::Inactive, E::Unplug}, S::Lost},
    {{S::Active, E::Unplug}, S::Lost},
    {{S::Fault, E::Unplug}, S::Lost},
};

TEST(OperatingState, EveryPairOfStateAndEventFollowsTheDesign) {
  for (std::size_t s = 0; s < kOperatingStateCount; ++s) {
    for (std::size_t e = 0; e < kLifecycleEventCount; ++e) {
      const auto state = static_cast<S>(s);
      const auto event = static_cast<E>(e);
      const auto expected = kLegal.find({state, event});

      const std::optional<S> actual = next_state(state, event);

      if (expected == kLegal.end()) {
        EXPECT_FALSE(actual.has_value()) << to_string(state) << " + " << to_string(event);
      } else {
        EXPECT_EQ(actual, expected->second) << to_string(state) << " + " << to_string(event);
      }
    }
  }
}

TEST(OperatingState, OnlyInactiveLeadsToActive) {
  for (std::size_t s = 0; s < kOperatingStateCount; ++s) {
    for (std::size_t e = 0; e < kLifecycleEventCount; ++e) {
      if (next_state(static_cast<S>(s), static_cast<E>(e)) != S::Active) continue;
      EXPECT_EQ(static_cast<S>(s), S::Inactive);
      EXPECT_EQ(static_cast<E>(e), E::Activate);
    }
  }
}

TEST(OperatingState, NamesAreDistinctAndOneThatDoesNotExistHasNone) {
  std::set<std::string_view> names;
  for (std::size_t s = 0; s < kOperatingStateCount; ++s) names.insert(to_string(static_cast<S>(s)));
  EXPECT_EQ(names.size(), kOperatingStateCount);
  EXPECT_EQ(names.count("unknown"), 0U);

  std::set<std::string_view> events;
  for (std::size_t e = 0; e < kLifecycleEventCount; ++e) {
    events.insert(to_string(static_cast<E>(e)));
  }
  EXPECT_EQ(events.size(), kLifecycleEventCount);
  EXPECT_EQ(events.count("unknown"), 0U);
  EXPECT_EQ(to_string(static_cast<S>(kOperatingStateCount)), "unknown");
  EXPECT_EQ(to_string(static_cast<E>(kLifecycleEventCount)), "unknown");
}

}  // namespace
}  // namespace thimble
