#include <gtest/gtest.h>

#include <set>

#include "hal/device/fault.hpp"

namespace thimble {
namespace {

constexpr MonotonicTime kAt{Duration(5)};

TEST(FaultLatch, FirstFaultWins) {
  FaultLatch sut;

  EXPECT_TRUE(sut.latch(FaultCode::Overspeed, kAt, 7));
  EXPECT_FALSE(sut.latch(FaultCode::StaleSample, kAt, 8));

  EXPECT_EQ(sut.fault().code, FaultCode::Overspeed);
  EXPECT_EQ(sut.fault().tick, 7U);
  EXPECT_EQ(sut.code(), FaultCode::Overspeed);
}

TEST(FaultLatch, NoneDoesNotLatch) {
  FaultLatch sut;
  EXPECT_FALSE(sut.latch(FaultCode::None, kAt, 1));
  EXPECT_FALSE(sut.is_latched());
}

TEST(FaultLatch, ClearsTheFaultThatIsNamedWhileHealthy) {
  FaultLatch sut;
  sut.latch(FaultCode::Overspeed, kAt, 1);

  EXPECT_EQ(sut.clear(sut.fault().number, true), ClearOutcome::Cleared);
  EXPECT_FALSE(sut.is_latched());
  EXPECT_EQ(sut.code(), FaultCode::None);
}

TEST(FaultLatch, ARequestForAnEarlierFaultDoesNotClearALaterOne) {
  FaultLatch sut;
  sut.latch(FaultCode::Overspeed, kAt, 1);
  const std::uint32_t first = sut.fault().number;
  ASSERT_EQ(sut.clear(first, true), ClearOutcome::Cleared);
  EXPECT_EQ(sut.clear(first, true), ClearOutcome::NotLatched) << "it is cleared already";
  sut.latch(FaultCode::Overspeed, kAt, 2);

  EXPECT_EQ(sut.clear(first, true), ClearOutcome::NotLatched);
  EXPECT_TRUE(sut.is_latched());
  EXPECT_EQ(sut.clear(0, true), ClearOutcome::NotLatched) << "the number of no fault";
  EXPECT_EQ(sut.clear(first + 1, true), ClearOutcome::Cleared);
}

TEST(FaultLatch, ARequestWhileUnhealthyIsRefused) {
  FaultLatch sut;
  sut.latch(FaultCode::Estop, kAt, 1);

  EXPECT_EQ(sut.clear(1, false), ClearOutcome::InputUnhealthy);
  EXPECT_TRUE(sut.is_latched());
  EXPECT_EQ(sut.clear(1, true), ClearOutcome::Cleared);
}

TEST(FaultCode, EveryCodeHasANameAndASentence) {
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < kFaultCodeCount; ++i) {
    const auto code = static_cast<FaultCode>(i);
    names.insert(to_string(code));
    EXPECT_NE(explain(code), "unknown fault") << to_string(code);
  }
  EXPECT_EQ(names.size(), kFaultCodeCount);
  EXPECT_EQ(names.count("unknown"), 0U);
}

// A number from a broken file or a later version.
TEST(FaultCode, OneThatDoesNotExistIsNamedAsSuch) {
  const auto code = static_cast<FaultCode>(kFaultCodeCount);
  EXPECT_EQ(to_string(code), "unknown");
  EXPECT_EQ(explain(code), "unknown fault");
}

}  // namespace
}  // namespace thimble
