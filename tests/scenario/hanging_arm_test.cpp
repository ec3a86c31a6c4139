// A real arm in whose opening or closing the kernel hangs, or that says nothing any more: what a
// person is told of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "daemon/session/arm_instruction.hpp"
#include "tests/scenario/two_real_arms.hpp"

namespace thimble {
namespace {

using test::kLeft;
using test::kRight;
using testing::HasSubstr;
using testing::Not;

class HangingArm : public testing::Test, protected test::TwoRealArms {};

// Else an arm would be opened while it is being closed.
TEST_F(HangingArm, AtTheStartIsOpenedByItsOwnWorkAndWaitedForButNotForEver) {
  plug(kLeft);
  plug(kRight);
  is_work_postponed_ = is_start_postponed_ = true;
  const MonotonicTime begun = clock_.now();
  start();
  EXPECT_EQ(clock_.now() - begun, 2 * session::kStartPatience);
  EXPECT_TRUE(bus_.tries.empty());
  EXPECT_EQ(state(kRight), OperatingState::Lost);
  EXPECT_THAT(session::instruction_for(rig(kRight)),
              HasSubstr("hid:right: the kernel has been opening it for 5 s"));
  for (int i = 0; i < 600; ++i) {
    for (test::PostponedExecutor& work : work_) work.do_all();
    run(0.01);
  }
  EXPECT_EQ(state(kLeft), OperatingState::Active);
  EXPECT_EQ(state(kRight), OperatingState::Active);
  EXPECT_EQ(bus_.tries["hid:right"], 2) << "what came too late was closed";
}

// Who reads that it is gone looks at a plug that is in its socket.
TEST_F(HangingArm, IsToldOfAsThatAndNotAsGone) {
  const auto is_told = [&](const std::string& instruction) {
    EXPECT_THAT(instruction, AllOf(HasSubstr("arm 'right': hid:right: the kernel has been"),
                                   HasSubstr(" for 4 s"), Not(HasSubstr("no device")),
                                   Not(HasSubstr("is gone"))));
    const auto of_right = std::count_if(troubles_.begin(), troubles_.end(), [](const Error& error) {
      return error.message.find("has been") != std::string::npos;
    });
    EXPECT_EQ(of_right, 1) << "the log has it once";
    troubles_.clear();
  };
  plug(kLeft);
  is_work_postponed_ = true;
  start();
  for (const bool has_been_there : {false, true}) {
    if (has_been_there) unplug(kRight);
    run(0.05);
    for (test::PostponedExecutor& work : work_) work.do_all();  // the closing, and a look
    plug(kRight);
    run(4.5);
    is_told(session::instruction_for(rig(kRight)));
    for (int i = 0; i < 600; ++i) {
      work_[kRight].do_all();
      run(0.01);
    }
    clear(kRight);  // it was driven when it was pulled
    run(0.1);
    EXPECT_EQ(state(kRight), OperatingState::Active) << has_been_there;
    EXPECT_EQ(session::instruction_for(rig(kRight)), "");
  }
}

// Nothing else stands there: its fault is cleared, and it is as calibrated as it was.
TEST_F(HangingArm, ThatSaysNothingOnceItsFaultIsClearedIsToldOf) {
  plug(kRight);
  const MonotonicTime mute = clock_.now() + std::chrono::seconds(6);
  sim::FaultPlan plan;
  plan.script = {{.kind = sim::FaultKind::Stall, .from = mute, .lasts = std::chrono::seconds(4)}};
  cables_.set_plan({"hid:right"}, plan);
  start();
  run(seconds(mute - clock_.now()) - 0.1);
  ASSERT_EQ(state(kRight), OperatingState::Active);
  run(0.5);
  ASSERT_EQ(rig(kRight).session().snapshot().fault.code, FaultCode::StaleSample);
  clear(kRight);
  run(0.5);
  EXPECT_EQ(state(kRight), OperatingState::Configured);
  EXPECT_EQ(session::instruction_for(rig(kRight)),
            "it does not report its position; check its power and cable");
  run(7);
  EXPECT_EQ(state(kRight), OperatingState::Active);
  EXPECT_EQ(session::instruction_for(rig(kRight)), "");
}

// Who asks for a guard has the device's file in his hands for a while: closed meanwhile, it would
// end in the thread that computes the worlds, however long that takes the kernel.
TEST_F(HangingArm, OneThatIsBeingClosedIsGivenToNoGuard) {
  plug(kRight);
  is_work_postponed_ = true;
  start();
  for (int turns_before = 0; turns_before < 5; ++turns_before) {
    SCOPED_TRACE(turns_before);
    plug(kRight);
    guards_.have_ended = false;
    for (int i = 0; i < 600; ++i) {
      work_[kRight].do_all();
      run(0.01);
    }
    ASSERT_NE(state(kRight), OperatingState::Lost);
    guards_.have_ended = true;
    for (int i = 0; i < turns_before; ++i) tick();
    guards_.watched.clear();
    unplug(kRight);
    run(0.05);
    EXPECT_THAT(guards_.watched, testing::IsEmpty());
  }
}

}  // namespace
}  // namespace thimble
