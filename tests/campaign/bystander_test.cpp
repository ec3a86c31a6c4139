#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/campaign/good_course.hpp"

// As invariants_test.cpp: seen to hold on a good course and to break on a planted breach.
namespace thimble::campaign {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

// The first arm does what it likes; the one nearby is driven from 0.3 s on.
struct Neighbours {
  using Spoil = std::function<void(servo::ServoSnapshot&)>;

  void run(int ticks, const Spoil& spoil = {}) {
    course.run(ticks, [&](Observation& now) {
      servo::ServoFrame& frame = nearby.frame;
      ++frame.tick;
      frame.now = now.servo.frame.now;
      frame.dt = milliseconds(1);
      frame.read_status = IoStatus::Ok;
      const bool is_driven = frame.now.since_epoch > milliseconds(900);
      frame.state = is_driven ? OperatingState::Active : OperatingState::Calibrating;
      frame.force = is_driven ? Force3{0.5, 0, 0} : Force3{};
      if (spoil) spoil(nearby);
      now.other = &nearby;
    });
  }

  GoodCourse course{[](Bounds bounds) {
    bounds.other_servo = bounds.servo;
    return make_bystander(bounds);
  }};
  servo::ServoSnapshot nearby{};
};

TEST(Bystander, IsNotAskedForWhereThereIsNone) {
  GoodCourse course(&make_bystander);
  course.run(6000);
  EXPECT_EQ(course.broken(), "");
}

TEST(Bystander, HoldsWhateverTheOtherArmDoes) {
  Neighbours sut;
  sut.run(400);
  sut.course.stop(OperatingState::Fault, FaultCode::Overspeed);
  sut.run(6000);
  EXPECT_EQ(sut.course.broken(), "");
}

TEST(Bystander, SeesWhatIsDoneToIt) {
  const std::vector<std::pair<const char*, Neighbours::Spoil>> cases{
      {"ticks advance", [](servo::ServoSnapshot& nearby) { ++nearby.frame.tick; }},
      {"latches nothing", [](servo::ServoSnapshot& nearby) { nearby.faults = 1; }},
      {"stays driven",
       [](servo::ServoSnapshot& nearby) { nearby.frame.state = OperatingState::Inactive; }},
      {"norm of the force sent",
       [](servo::ServoSnapshot& nearby) {
         nearby.frame.force = {50, 0, 0};
       }},
  };
  for (const auto& [rule, spoil] : cases) {
    Neighbours sut;
    sut.run(500);
    EXPECT_EQ(sut.course.broken(), "");
    sut.run(1, spoil);
    EXPECT_THAT(sut.course.broken(), HasSubstr(rule));
  }
}

TEST(Bystander, SeesThatItIsNeverDrivenOrHearsNothing) {
  Neighbours idle;
  idle.run(4500, [](servo::ServoSnapshot& nearby) {
    nearby.frame.state = OperatingState::Calibrating;
    nearby.frame.force = {};
  });
  EXPECT_THAT(idle.course.broken(), HasSubstr("driven in time"));
  Neighbours deaf;
  deaf.run(500);
  deaf.run(52, [](servo::ServoSnapshot& nearby) { nearby.frame.read_status = IoStatus::NoData; });
  EXPECT_THAT(deaf.course.broken(), HasSubstr("no sample taken"));
}

}  // namespace
}  // namespace thimble::campaign
