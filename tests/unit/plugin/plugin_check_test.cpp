#include "hal/plugin/plugin_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <random>
#include <vector>

namespace thimble::plugin {
namespace {

using testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

thimble_capabilities good_capabilities() {
  thimble_capabilities said{};
  said.joint_count = 3;
  std::strcpy(said.model, "arm");
  said.peak_force_newton = 8;
  said.continuous_force_newton = 2;
  said.max_stiffness_newton_per_m = 1000;
  said.workspace_radius_m = 0.1;
  for (double& current : said.peak_current_a) current = 3;
  for (double& current : said.continuous_current_a) current = 1;
  said.sample_period_ns = 1'000'000;
  said.device_watchdog_ns = 50'000'000;
  return said;
}

TEST(PluginCapabilities, AreTakenAsTheyAre) {
  const auto sut = read_capabilities(good_capabilities());
  ASSERT_TRUE(sut) << sut.error().message;
  EXPECT_EQ(sut->model, "arm");
  EXPECT_EQ(sut->joint_count, 3U);
  EXPECT_EQ(sut->peak_force_newton, 8);
  EXPECT_EQ(sut->continuous_force_newton, 2);
  EXPECT_EQ(sut->max_stiffness_newton_per_m, 1000);
  EXPECT_EQ(sut->workspace_radius_m, 0.1);
  EXPECT_EQ(sut->peak_current_a, (std::array{3.0, 3.0, 3.0}));
  EXPECT_EQ(sut->continuous_current_a, (std::array{1.0, 1.0, 1.0}));
  EXPECT_EQ(sut->sample_period, std::chrono::milliseconds(1));
  EXPECT_EQ(sut->device_watchdog, std::chrono::milliseconds(50));
  EXPECT_EQ(sut->full_rate_hz, 1000) << "as of one that does not know this number";
  EXPECT_EQ(sut->most_current_a_per_newton, (std::array{0.0, 0.0, 0.0}));
}

TEST(PluginCapabilities, SayTheRateAtWhichTheServoGetsEverySample) {
  auto said = good_capabilities();
  for (const double rate_hz : {500.0, 4000.0, 8000.0}) {
    said.full_rate_hz = rate_hz;
    const auto sut = read_capabilities(said);
    ASSERT_TRUE(sut) << sut.error().message;
    EXPECT_EQ(sut->full_rate_hz, rate_hz);
  }
}

TEST(PluginCapabilities, SayWhatANewtonAsksOfEachMotorAtMost) {
  auto said = good_capabilities();
  said.most_current_a_per_newton[1] = 0.4;
  said.most_current_a_per_newton[2] = 1e4;
  const auto sut = read_capabilities(said);
  ASSERT_TRUE(sut) << sut.error().message;
  EXPECT_EQ(sut->most_current_a_per_newton, (std::array{0.0, 0.4, 1e4}));
}

TEST(PluginCapabilities, ThatNoArmHasAreRefused) {
  using Number = double thimble_capabilities::*;
  for (const Number number :
       {&thimble_capabilities::peak_force_newton, &thimble_capabilities::continuous_force_newton,
        &thimble_capabilities::max_stiffness_newton_per_m,
        &thimble_capabilities::workspace_radius_m}) {
    for (const double bad : {0.0, -1.0, 1e9, kNaN, kInfinity}) {
      auto said = good_capabilities();
      said.*number = bad;
      EXPECT_FALSE(read_capabilities(said)) << bad;
    }
  }
  const std::vector<std::function<void(thimble_capabilities&)>> lies{
      [](auto& said) { said.model[0] = '\0'; },
      [](auto& said) { std::memset(said.model, 'a', sizeof(said.model)); },
      [](auto& said) { said.joint_count = 2; },
      [](auto& said) { said.joint_count = 4; },
      [](auto& said) { said.joint_count = 7; },
      [](auto& said) { said.peak_force_newton = 101; },
      [](auto& said) { said.continuous_force_newton = 8.1; },
      [](auto& said) { said.peak_current_a[1] = kNaN; },
      [](auto& said) { said.peak_current_a[2] = 101; },
      [](auto& said) { said.continuous_current_a[0] = 0; },
      [](auto& said) { said.continuous_current_a[0] = 3.1; },
      [](auto& said) { said.sample_period_ns = 99'999; },
      [](auto& said) { said.sample_period_ns = INT64_MAX; },
      [](auto& said) { said.device_watchdog_ns = -1; },
      [](auto& said) { said.device_watchdog_ns = INT64_MAX; },
      [](auto& said) { said.most_current_a_per_newton[1] = -1; },
      [](auto& said) { said.most_current_a_per_newton[1] = 1e-300; },
      [](auto& said) { said.most_current_a_per_newton[1] = 9e-7; },
      [](auto& said) { said.most_current_a_per_newton[2] = 1.1e4; },
      [](auto& said) { said.most_current_a_per_newton[0] = kNaN; },
      [](auto& said) { said.full_rate_hz = -4000; },
      [](auto& said) { said.full_rate_hz = 499; },
      [](auto& said) { said.full_rate_hz = 8001; },
      [](auto& said) { said.full_rate_hz = kNaN; },
      [](auto& said) { said.full_rate_hz = kInfinity; },
  };
  for (std::size_t i = 0; i < lies.size(); ++i) {
    auto said = good_capabilities();
    lies[i](said);
    EXPECT_FALSE(read_capabilities(said)) << i;
  }
}

thimble_sample good_sample() {
  thimble_sample sample{};
  sample.calibration = THIMBLE_CALIBRATION_DONE;
  sample.motor_current_a_per_newton[0][0] = 0.4;
  return sample;
}

TEST(PluginSample, IsSoundOnlyWithEveryNumberInItsRange) {
  EXPECT_TRUE(is_sound(good_sample()));
  const std::size_t first = offsetof(thimble_sample, joint_position_rad) / sizeof(double);
  for (std::size_t i = first; i < sizeof(thimble_sample) / sizeof(double); ++i) {
    for (const double bad : {kNaN, kInfinity, -kInfinity, 1e7, -1e300}) {
      auto sample = good_sample();
      std::memcpy(reinterpret_cast<char*>(&sample) + i * sizeof(double), &bad, sizeof(bad));
      EXPECT_FALSE(is_sound(sample)) << i << " " << bad;
    }
  }
  for (const std::int32_t bad : {-1, 3, INT32_MIN, INT32_MAX}) {
    auto sample = good_sample();
    sample.calibration = bad;
    EXPECT_FALSE(is_sound(sample)) << bad;
  }
}

TEST(PluginSample, TurnsAGimbalByHalfATurnAtMost) {
  for (std::size_t i = 3; i < 6; ++i) {
    auto sample = good_sample();
    sample.joint_position_rad[i] = -3.14159265358979;
    EXPECT_TRUE(is_sound(sample));
    sample.joint_position_rad[i] = 3.15;
    EXPECT_FALSE(is_sound(sample));
  }
}

TEST(PluginSample, WithoutAnyCurrentIsSoundOnlyBeforeCalibration) {
  thimble_sample sample{};
  EXPECT_TRUE(is_sound(sample));
  sample.calibration = THIMBLE_CALIBRATION_NEEDS_PERSON;
  EXPECT_TRUE(is_sound(sample));
  sample.calibration = THIMBLE_CALIBRATION_DONE;
  EXPECT_FALSE(is_sound(sample)) << "no current of any motor would be limited";
}

TEST(PluginModelFacts, MustBeThoseOfABus) {
  thimble_model_facts facts{};
  facts.frame_period_ns = 1'000'000;
  facts.info.input_report_bytes = 64;
  facts.info.output_report_bytes = 1;
  EXPECT_TRUE(check_facts(facts));
  for (const std::int64_t bad_ns : {INT64_MIN, std::int64_t{0}, std::int64_t{124'999}, INT64_MAX}) {
    auto lie = facts;
    lie.frame_period_ns = bad_ns;
    EXPECT_FALSE(check_facts(lie)) << bad_ns;
  }
  for (const std::uint32_t bad : {0U, 65U, UINT32_MAX}) {
    auto lie = facts;
    lie.info.input_report_bytes = bad;
    EXPECT_FALSE(check_facts(lie)) << bad;
    lie = facts;
    lie.info.output_report_bytes = bad;
    EXPECT_FALSE(check_facts(lie)) << bad;
  }
  facts.home_m[1] = kNaN;
  EXPECT_FALSE(check_facts(facts));
}

// A plugin in one piece of memory that stands for its object, so that all may be written over.
struct Object {
  thimble_plugin plugin;
  thimble_driver driver;
  thimble_model model;
  const thimble_model* models[1];
};

std::int32_t any_match(const thimble_hid_info*, const thimble_driver_settings*, thimble_reason*) {
  return THIMBLE_NOT_MINE;
}
void any_leave(void*) {}

// Functions that are "in the object": this one, whatever its type.
template <class Function>
Function some_function() {
  return reinterpret_cast<Function>(reinterpret_cast<void*>(&any_leave));
}

void fill(Object& object) {
  thimble_driver& driver = object.driver;
  driver = {sizeof(driver), 0,          "arm",   &any_match, nullptr,
            &any_leave,     &any_leave, nullptr, nullptr};
  driver.open = some_function<decltype(driver.open)>();
  driver.decode = some_function<decltype(driver.decode)>();
  driver.encode = some_function<decltype(driver.encode)>();
  thimble_model& model = object.model;
  model = {};
  model.struct_bytes = sizeof(model);
  std::strcpy(model.name, "arm");
  model.create = some_function<decltype(model.create)>();
  model.destroy = model.power_cycle = &any_leave;
  model.advance = some_function<decltype(model.advance)>();
  model.out_report = some_function<decltype(model.out_report)>();
  model.in_report = some_function<decltype(model.in_report)>();
  model.hold_tip = some_function<decltype(model.hold_tip)>();
  model.push_tip = some_function<decltype(model.push_tip)>();
  model.move_tip_to = some_function<decltype(model.move_tip_to)>();
  model.press_calibration_button = some_function<decltype(model.press_calibration_button)>();
  model.press_stylus_button = some_function<decltype(model.press_stylus_button)>();
  model.turn_stylus = some_function<decltype(model.turn_stylus)>();
  model.read_truth = some_function<decltype(model.read_truth)>();
  object.models[0] = &model;
  object.plugin = {THIMBLE_PLUGIN_MAGIC,
                   THIMBLE_PLUGIN_ABI_VERSION,
                   THIMBLE_PLUGIN_ABI_REVISION,
                   sizeof(thimble_plugin),
                   &driver,
                   object.models,
                   1,
                   0,
                   nullptr};
}

bool is_in(const Object& object, const void* start, std::size_t bytes, Access access) {
  const bool is_function = start == reinterpret_cast<const void*>(&any_leave) ||
                           start == reinterpret_cast<const void*>(&any_match);
  if (access == Access::Execute) return is_function;
  const auto from = reinterpret_cast<std::uintptr_t>(start);
  const auto first = reinterpret_cast<std::uintptr_t>(&object);
  return from >= first && from < first + sizeof(object) && bytes <= first + sizeof(object) - from;
}

Result<void> judge(const Object& object) {
  return check_plugin(object.plugin, sizeof(thimble_plugin),
                      [&](const void* start, std::size_t bytes, Access access) {
                        return is_in(object, start, bytes, access);
                      });
}

TEST(PluginCheck, ReadsNothingOutsideTheObjectHoweverItIsWrittenOver) {
  std::mt19937_64 random(5);
  int taken = 0;
  int refused = 0;
  for (int round = 0; round < 20000; ++round) {
    auto object = std::make_unique<Object>();  // of its own: AddressSanitizer sees its ends
    fill(*object);
    ASSERT_TRUE(judge(*object)) << judge(*object).error().message;
    auto* bytes = reinterpret_cast<unsigned char*>(object.get());
    for (auto left = 1 + random() % 3; left > 0; --left) {
      // Mostly near the truth: one bit, or a pointer into the object.
      const std::size_t at = random() % (sizeof(Object) / 8) * 8;
      const std::uint64_t word =
          random() % 2 == 0 ? random() : reinterpret_cast<std::uintptr_t>(bytes) + random() % 1200;
      if (random() % 2 == 0) {
        bytes[at + random() % 8] ^= static_cast<unsigned char>(1U << random() % 8);
      } else {
        std::memcpy(bytes + at, &word, sizeof(word));
      }
    }
    judge(*object) ? ++taken : ++refused;
  }
  // Texts and reserved words may be anything; the rest may not.
  EXPECT_GT(taken, 1000);
  EXPECT_GT(refused, 1000);
}

TEST(PluginCheck, ReadsNothingOfADescriptorThatIsNotInTheObject) {
  const auto* nowhere = reinterpret_cast<const thimble_plugin*>(8);
  for (const std::size_t bytes : {std::size_t{0}, sizeof(thimble_plugin), SIZE_MAX}) {
    std::size_t asked = 0;
    const auto checked = check_plugin(*nowhere, bytes, [&](const void*, std::size_t some, Access) {
      asked = some;
      return false;
    });
    ASSERT_FALSE(checked);
    EXPECT_THAT(checked.error().message, HasSubstr("is not in the file"));
    EXPECT_LE(asked, sizeof(thimble_plugin));
  }
}

TEST(PluginCheck, ReadsNoFurtherThanTheSymbolGoes) {
  Object object;
  fill(object);
  for (std::size_t bytes = 0; bytes < sizeof(thimble_plugin); ++bytes) {
    auto head = std::make_unique<unsigned char[]>(bytes + 1);
    std::memcpy(head.get(), &object.plugin, bytes);
    const auto checked =
        check_plugin(*reinterpret_cast<const thimble_plugin*>(head.get()), bytes,
                     [&](const void* start, std::size_t, Access) { return start == head.get(); });
    EXPECT_FALSE(checked) << bytes;
  }
}

}  // namespace
}  // namespace thimble::plugin
