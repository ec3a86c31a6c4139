#include "sim/model/cam/engine/block_team.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <random>
#include <set>
#include <vector>

#include "sim/model/cam/engine/plane_engine.hpp"
#include "tests/unit/cam_engine/plain_space.hpp"

namespace thimble::sim::cam {
namespace {

struct Done {
  int times{0};
  std::size_t member{0};
  std::thread::id thread{};
};

TEST(BlockTeam, DoesEachBlockOnceAndAMemberIsOneThread) {
  std::mt19937 random(61);
  for (const std::size_t members : {1U, 2U, 3U, 8U}) {
    BlockTeam sut(members);
    ASSERT_EQ(sut.size(), members);
    std::vector<std::set<std::thread::id>> threads(members);
    for (int scan = 0; scan < 500; ++scan) {
      std::vector<Done> done(random() % 40);
      sut.run(done.size(), [&](std::size_t member, std::size_t block) {
        done[block] = {done[block].times + 1, member, std::this_thread::get_id()};
      });
      for (const Done& block : done) {
        ASSERT_EQ(block.times, 1);
        ASSERT_LT(block.member, members);
        threads[block.member].insert(block.thread);
      }
    }
    for (const auto& ids : threads) EXPECT_LE(ids.size(), 1U);
    EXPECT_EQ(threads[0].count(std::this_thread::get_id()), 1U) << "the caller's blocks";
  }
}

TEST(BlockTeam, OthersDoWhatTheCallerLeaves) {
  BlockTeam sut(2);
  std::mutex mutex;
  std::condition_variable came;
  std::set<std::size_t> members;
  // Neither goes on before the other has come.
  sut.run(2, [&](std::size_t member, std::size_t) {
    std::unique_lock lock(mutex);
    members.insert(member);
    came.notify_all();
    came.wait(lock, [&] { return members.size() == 2; });
  });
  EXPECT_EQ(members, (std::set<std::size_t>{0, 1}));
}

TEST(BlockTeam, EndsWhetherOrNotItWasUsed) {
  std::atomic<int> done{0};
  for (int i = 0; i < 100; ++i) {
    BlockTeam sut(4);
    if (i % 2 == 0) sut.run(1, [&](std::size_t, std::size_t) { ++done; });
  }
  EXPECT_EQ(done, 50);
}

class SharedScans : public testing::TestWithParam<TablePath> {};
INSTANTIATE_TEST_SUITE_P(Paths, SharedScans,
                         testing::Values(TablePath::General, TablePath::Compiled));

TEST_P(SharedScans, AreThoseOfOneThreadBitForBit) {
  std::mt19937 random(62);
  for (const std::array<int, 3>& axes : {std::array{9, 9, 0}, {6, 6, 6}, {3, 9, 6}, {8, 6, 0}}) {
    const SiteSpace space{axes};
    const auto one = PlaneEngine::make(space, GetParam()).value();
    const auto three = PlaneEngine::make(space, GetParam(), *usable_kernels().front(), 3).value();
    const test::Cells cells = test::random_cells(space.sites(), random);
    ASSERT_TRUE(one->put(cells) && three->put(cells));
    for (int i = 0; i < 12; ++i) {
      if (i % 4 == 0) {
        const test::Table table = GetParam() == TablePath::General
                                      ? test::random_table(random)
                                      : test::random_small_table(random);
        ASSERT_TRUE(one->load(0, table) && three->load(0, table));
      }
      const auto layers = static_cast<LayerBits>(random());
      const int cells_on = static_cast<int>(random() % 9) - 4;
      const std::vector<PlaneKick> kicks{{layers, {cells_on, -cells_on, 1}}};
      StepOptions options;
      options.counting = static_cast<Counting>(random() % 3);
      if (i % 3 == 0) options.written = static_cast<LayerBits>(random());
      if (i % 5 == 0) options.fixed = static_cast<LayerBits>(random());
      const auto expected = one->step(kicks, options);
      const auto counts = three->step(kicks, options);
      ASSERT_TRUE(expected && counts);
      ASSERT_EQ(*counts, *expected) << i;
      ASSERT_EQ(three->population(), one->population()) << i;
    }
    test::Cells expected(space.sites());
    test::Cells got(space.sites());
    ASSERT_TRUE(one->get(expected) && three->get(got));
    ASSERT_EQ(got, expected);
  }
}

TEST(PlaneEngineMake, NumbersOfThreadsThatCannotBeAreRefused) {
  for (const std::size_t threads : {std::size_t{0}, PlaneEngine::kMostThreads + 1}) {
    const auto made =
        PlaneEngine::make({{6, 0, 0}}, TablePath::Auto, *usable_kernels().front(), threads);
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, Errc::InvalidArgument);
  }
}

}  // namespace
}  // namespace thimble::sim::cam
