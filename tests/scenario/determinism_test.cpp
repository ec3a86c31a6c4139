#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/scenario/trace.hpp"

namespace thimble {
namespace {

using test::ClosedLoop;

std::uint64_t trace_of(const std::vector<std::string>& overrides, double s = 20) {
  ClosedLoop loop(overrides);
  sim::TraceHash hash;
  loop.run(s, [&] { test::add_to(hash, loop.frame()); });
  EXPECT_GT(loop.snapshot().total_contacts, 0U);
  return hash.value();
}

TEST(Determinism, TheSameConfigurationAndSeedGiveTheSameTrace) {
  EXPECT_EQ(trace_of({}), trace_of({}));
  const std::vector<std::string> bad_network{
      "arm.impairment.delay_s=0.04", "arm.impairment.jitter_s=0.01", "arm.impairment.loss=0.05"};
  EXPECT_EQ(trace_of(bad_network), trace_of(bad_network));
}

TEST(Determinism, AnotherSeedOfTheHandOrOfTheNetworkGivesAnotherTrace) {
  EXPECT_NE(trace_of({}, 5), trace_of({"arm.hand.seed=2"}, 5));
  // A map makes what is felt in a world that stays the same on every network.
  const std::string ghost = "arm.coupling.scheme=ghost-point";
  const std::string loss = "arm.impairment.loss=0.05";
  EXPECT_NE(trace_of({ghost, loss, "arm.impairment.seed=1"}, 5),
            trace_of({ghost, loss, "arm.impairment.seed=2"}, 5));
}

TEST(Determinism, ABadCableIsRepeatableToo) {
  const auto run = [] {
    ClosedLoop::Setup setup;
    setup.cables.seed = 7;
    setup.cables.random.drop_in = 0.03;
    ClosedLoop loop({}, setup);
    sim::TraceHash hash;
    loop.run(10, [&] { test::add_to(hash, loop.frame()); });
    EXPECT_GT(loop.snapshot().missed_exchanges, 0U);
    return hash.value();
  };
  EXPECT_EQ(run(), run());
}

}  // namespace
}  // namespace thimble
