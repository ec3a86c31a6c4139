#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "drivers/falcon/firmware_image.hpp"
#include "tests/scenario/at_each_rate.hpp"
#include "tests/support/arm_watch.hpp"
#include "tests/support/falcon_image.hpp"
#include "tests/support/temporary_folder.hpp"

// Nothing here resets an arm (decision 0403), but a kernel does after trouble on a bus, and whoever
// may write to a node can (USBDEVFS_RESET). At worst its firmware begins anew while it is driven,
// and whoever has it open hears of nothing but silence.
namespace thimble {
namespace {

using test::ArmWatch;
using test::ClosedLoop;

constexpr const char* kFalcon = "sim:falcon";
constexpr const char* kArms[] = {"sim:phantom-vintage", "sim:phantom-vintage-serial", kFalcon};

void begin_anew(plugin::ArmBackend& arm) {
  auto* const hid = dynamic_cast<plugin::SimHidModel*>(&arm);
  auto* const usb = dynamic_cast<plugin::SimUsbModel*>(&arm);
  auto* const serial = dynamic_cast<plugin::SimSerialModel*>(&arm);
  ASSERT_EQ((hid != nullptr) + (usb != nullptr) + (serial != nullptr), 1);
  if (hid != nullptr) hid->power_cycle();
  if (usb != nullptr) usb->power_cycle();
  if (serial != nullptr) serial->power_cycle();
}

class ResetArm : public test::AtEachRate {
 protected:
  std::vector<std::string> with_arm(const char* arm) {
    std::vector<std::string> words{std::string("arm.0.device=") + arm, "arm.hand.motion=still"};
    if (std::string_view(arm) == kFalcon) {
      words.push_back("arm.0.firmware=" + firmware_.string());
      words.push_back("arm.0.firmware_sha256=" + falcon::sha256_of(image_));
      // One that nobody has measured is weak.
      words.push_back("arm.0.newton_per_count=0.00244");
    }
    return with(words);
  }
  static bool is_active(ClosedLoop& loop) { return loop.frame().state == OperatingState::Active; }

 private:
  const testing_support::TemporaryFolder folder_;
  const std::vector<std::uint8_t> image_ = test::falcon_image();
  const std::filesystem::path firmware_ =
      folder_.write("image", {reinterpret_cast<const char*>(image_.data()), image_.size()});
};
THIMBLE_AT_EACH_RATE(ResetArm);

TEST_P(ResetArm, WhichIsPressedByTheWallLetsGoAndNothingReturnsUnasked) {
  for (const char* arm : kArms) {
    SCOPED_TRACE(arm);
    ClosedLoop sut(with_arm(arm));
    sut.run_until_leaning();
    ASSERT_GT(norm(sut.truth().motor_force), 0.1);
    begin_anew(sut.sim_arm().backend());
    EXPECT_EQ(norm(sut.truth().motor_force), 0);
    ArmWatch watch(sut);
    sut.run(0.05, [&] {
      watch.see();
      EXPECT_EQ(norm(sut.truth().motor_force), 0) << "of commands on the way";
    });
    EXPECT_FALSE(is_active(sut));
    // The wall is still where the hand is, and the person does what the status asks for.
    sut.run(8, [&] {
      watch.see();
      ASSERT_EQ(norm(sut.truth().motor_force), 0);
      ASSERT_FALSE(is_active(sut));
    });
    EXPECT_TRUE(sut.snapshot().fault.code == FaultCode::StaleSample ||
                sut.snapshot().fault.code == FaultCode::LostReference)
        << to_string(sut.snapshot().fault.code);
    EXPECT_EQ(watch.breach(), "");
  }
}

TEST_P(ResetArm, IsDrivenAgainWhenItIsClearedAndCalibratedWithTheNewReference) {
  for (const char* arm : kArms) {
    SCOPED_TRACE(arm);
    ClosedLoop sut(with_arm(arm));
    sut.run_until_leaning();
    ArmWatch watch(sut);
    begin_anew(sut.sim_arm().backend());
    sut.run(2, [&] { watch.see(); });
    sut.controls().request_clear(sut.snapshot().fault.number);
    sut.run(0.6, [&] { watch.see(); });
    sut.sim_arm().backend().push_tip({});  // and the person brings it home
    ASSERT_TRUE(sut.run_until(20,
                              [&] {
                                watch.see();
                                return is_active(sut);
                              }))
        << to_string(sut.frame().state) << ": " << sut.instruction();
    EXPECT_LT(norm(sut.frame().tip - sut.truth().tip), 1e-3);
    EXPECT_EQ(watch.breach(), "");
  }
}

}  // namespace
}  // namespace thimble
