#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/allocation_count.hpp"
#include "tests/support/closed_loop.hpp"

// What a session keeps of an arm that comes and goes: not a byte that it did not have before. What
// the operating system's libraries keep is counted in the guest (tests/vm/test_plug_cycles.py).
namespace thimble {
namespace {

using test::ClosedLoop;

constexpr std::size_t kFirst = 8;  // in these the room for a recording is made
constexpr std::size_t kCycles = 16;

class PlugCycles : public testing::TestWithParam<const char*> {};

TEST_P(PlugCycles, KeepNoMemory) {
  ClosedLoop sut({std::string("arm.0.device=sim:") + GetParam(), "arm.hand.motion=still"});
  std::vector<std::int64_t> bytes;
  bytes.reserve(kFirst + kCycles);
  for (std::size_t i = 0; i < kFirst + kCycles; ++i) {
    ASSERT_TRUE(sut.run_until(4, [&] { return sut.frame().state != OperatingState::Lost; }))
        << i << ": " << sut.instruction();
    // It is calibrated meanwhile, or pulled while it is.
    sut.run(i % 4 == 3 ? 2 : 0.05, [] {});
    sut.unplug();
    sut.tick();
    ASSERT_EQ(sut.frame().state, OperatingState::Lost);
    sut.run(0.05, [] {});
    bytes.push_back(test::allocated_bytes());
    sut.replug();
  }
  for (std::size_t i = kFirst + 1; i < kFirst + kCycles; ++i)
    EXPECT_EQ(bytes[i], bytes[kFirst]) << i;
}

INSTANTIATE_TEST_SUITE_P(Arms, PlugCycles,
                         testing::Values("phantom-vintage", "phantom-vintage-serial",
                                         "falcon-loaded", "falcon", "spacenavigator"));

}  // namespace
}  // namespace thimble
