#include "hal/device/haptic_device.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstddef>
#include <functional>
#include <set>
#include <type_traits>
#include <vector>

namespace thimble {
namespace {

// No way around the limiter: a force is made neither of numbers nor of bytes.
template <class Target>
concept IsMadeOfBytes = requires(std::array<std::byte, sizeof(Target)> bytes) {
  std::bit_cast<Target>(bytes);
};
static_assert(IsMadeOfBytes<Force3>);
static_assert(!IsMadeOfBytes<LimitedWrench>);
static_assert(!std::is_constructible_v<LimitedWrench, Force3>);
static_assert(!std::is_aggregate_v<LimitedWrench>);

// An arm that returns is judged by this: another limit, and it is another arm.
TEST(HapticCapabilities, OfTwoArmsDifferWhereverOneNumberDoes) {
  using Change = std::function<void(HapticCapabilities&)>;
  const std::vector<Change> changes{
      [](HapticCapabilities& arm) { arm.model = "other"; },
      [](HapticCapabilities& arm) { arm.joint_count = 6; },
      [](HapticCapabilities& arm) { arm.is_actuated = false; },
      [](HapticCapabilities& arm) { arm.peak_force_newton = 1; },
      [](HapticCapabilities& arm) { arm.continuous_force_newton = 1; },
      [](HapticCapabilities& arm) { arm.max_stiffness_newton_per_m = 1; },
      [](HapticCapabilities& arm) { arm.workspace_radius_m = 1; },
      [](HapticCapabilities& arm) { arm.peak_current_a[2] = 1; },
      [](HapticCapabilities& arm) { arm.continuous_current_a[2] = 1; },
      [](HapticCapabilities& arm) { arm.most_current_a_per_newton[2] = 1; },
      [](HapticCapabilities& arm) { arm.sample_period = Duration(1); },
      [](HapticCapabilities& arm) { arm.full_rate_hz = 4000; },
      [](HapticCapabilities& arm) { arm.device_watchdog = Duration(1); }};
  const HapticCapabilities one;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    HapticCapabilities other;
    EXPECT_EQ(one, other);
    changes[i](other);
    EXPECT_NE(one, other) << i;
  }
}

TEST(CalibrationState, EachHasANameAndOneThatDoesNotExistIsUnknown) {
  std::set<std::string_view> names;
  for (int i = 0; i < 4; ++i) names.insert(to_string(static_cast<CalibrationState>(i)));
  EXPECT_EQ(names, (std::set<std::string_view>{"unknown", "needs-user", "ok"}));
}

}  // namespace
}  // namespace thimble
