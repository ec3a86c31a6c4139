#include "sim/model/cam/engine/vector_kernels.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <vector>

#include "tests/unit/cam_engine/plain_space.hpp"

namespace thimble::sim::cam {
namespace {

using Block = std::array<Word, kBlockWords>;
using Planes = std::array<Block, kPlanes>;

class VectorKernelsTest : public test::EachInstructionSet {
 protected:
  static Word random_word() { return Word{random_()} << 32 | random_(); }
  static Planes random_planes() {
    Planes planes;
    for (Block& plane : planes) {
      for (Word& word : plane) word = random_word();
    }
    return planes;
  }
  static std::uint16_t site_of(const Planes& planes, std::size_t site) {
    std::uint32_t value = 0;
    for (std::size_t layer = 0; layer < kPlanes; ++layer) {
      value |= static_cast<std::uint32_t>(planes[layer][site / 64] >> site % 64 & 1) << layer;
    }
    return static_cast<std::uint16_t>(value);
  }
  template <class Pointer>
  static std::array<Pointer, kPlanes> pointers(Planes& planes) {
    std::array<Pointer, kPlanes> all{};
    for (std::size_t layer = 0; layer < kPlanes; ++layer) all[layer] = planes[layer].data();
    return all;
  }

  const VectorKernels& kernels{*GetParam()};

 private:
  inline static std::mt19937 random_{31};
};
INSTANTIATE_TEST_SUITE_P(Kernels, VectorKernelsTest, test::instruction_sets(), test::set_name);

TEST(VectorKernelsChoice, TheBuildsOwnInstructionSetIsAlwaysThere) {
  ASSERT_FALSE(usable_kernels().empty());
  EXPECT_EQ(usable_kernels().back(), built_kernels().back());
  for (std::size_t i = 1; i < usable_kernels().size(); ++i) {
    EXPECT_GT(usable_kernels()[i - 1]->lanes, usable_kernels()[i]->lanes);
  }
}

TEST_P(VectorKernelsTest, EachSiteGoesThroughTheTable) {
  std::mt19937 random(32);
  const test::Table table = test::random_table(random);
  Planes in = random_planes();
  Planes out = random_planes();
  kernels.apply_table(pointers<const Word*>(in).data(), table.data(), pointers<Word*>(out).data());
  for (std::size_t site = 0; site < kBlockSites; ++site) {
    ASSERT_EQ(site_of(out, site), table[site_of(in, site)]) << site;
  }
}

TEST_P(VectorKernelsTest, PlanesBecomeSitesAndPlanesAgain) {
  Planes planes = random_planes();
  std::vector<std::uint16_t> sites(kBlockSites);
  kernels.to_sites(pointers<const Word*>(planes).data(), sites.data());
  for (std::size_t site = 0; site < kBlockSites; ++site) {
    ASSERT_EQ(sites[site], site_of(planes, site)) << site;
  }
  Planes back{};
  kernels.from_sites(sites.data(), pointers<Word*>(back).data());
  EXPECT_EQ(back, planes);
}

TEST_P(VectorKernelsTest, RowsAreTurnedRoundTheirEnds) {
  const Planes planes = random_planes();
  const Block& in = planes[0];
  for (std::size_t row_words = 1; row_words <= kernels.lanes; row_words *= 2) {
    for (std::size_t by = 0; by < 64 * row_words; by += 1 + by % 7) {
      Block out{};
      kernels.rotate_rows(in.data(), out.data(), row_words, by / 64,
                          static_cast<unsigned>(by % 64));
      for (std::size_t bit = 0; bit < kBlockSites; ++bit) {
        const std::size_t row = bit / 64 & ~(row_words - 1);
        const std::size_t from = row * 64 + (bit - row * 64 + by) % (64 * row_words);
        ASSERT_EQ(out[bit / 64] >> bit % 64 & 1, in[from / 64] >> from % 64 & 1)
            << row_words << " words, by " << by << ", bit " << bit;
      }
    }
  }
}

TEST_P(VectorKernelsTest, WordsAreShiftedIntoEachOther) {
  const Planes planes = random_planes();
  const Block& in = planes[0];
  for (std::size_t count = 0; count < kBlockWords; ++count) {
    for (const unsigned bits : {1U, 31U, 63U}) {
      Block out{};
      kernels.shift_words(in.data(), out.data(), count, bits);
      for (std::size_t i = 0; i < kBlockWords; ++i) {
        const Word expected = i < count ? in[i] >> bits | in[i + 1] << (64 - bits) : 0;
        ASSERT_EQ(out[i], expected) << count << " " << bits << " " << i;
      }
    }
  }
}

TEST_P(VectorKernelsTest, OnesAreCounted) {
  const Block none{};
  EXPECT_EQ(kernels.count_ones(none.data(), kBlockWords), 0U);
  Block some{};
  some[3] = 0xf0;
  some[9] = ~Word{0};
  EXPECT_EQ(kernels.count_ones(some.data(), kBlockWords), 68U);
  EXPECT_EQ(kernels.count_ones(some.data(), 9), 4U);
}

// Each operation by its definition, on all values of its operands at once.
TEST_P(VectorKernelsTest, OperationsDoWhatTheySay) {
  using Code = PlaneOp::Code;
  const Word acc = 0xf0f0f0f0f0f0f0f0;
  const Word a = 0xcccccccccccccccc;
  const Word b = 0xaaaaaaaaaaaaaaaa;
  const auto run = [&](Code code) {
    std::array<Block, 4> blocks{};
    blocks[0].fill(acc);
    blocks[1].fill(a);
    blocks[2].fill(b);
    const std::array<PlaneOp, 3> ops{{{Code::Load, 0}, {code, 1, 2}, {Code::Store, 3}}};
    const std::array<Word*, 4> places{blocks[0].data(), blocks[1].data(), blocks[2].data(),
                                      blocks[3].data()};
    kernels.run_ops(ops.data(), ops.size(), places.data());
    EXPECT_TRUE(std::all_of(blocks[3].begin(), blocks[3].end(),
                            [&](Word word) { return word == blocks[3][0]; }));
    EXPECT_EQ(blocks[1][63], code == Code::Store ? acc : code == Code::StoreNot ? ~acc : a);
    return blocks[3][0];
  };
  EXPECT_EQ(run(Code::Zero), 0U);
  EXPECT_EQ(run(Code::Load), a);
  EXPECT_EQ(run(Code::Store), acc);
  EXPECT_EQ(run(Code::StoreNot), acc);
  EXPECT_EQ(run(Code::And), acc & a);
  EXPECT_EQ(run(Code::AndNot), acc & ~a);
  EXPECT_EQ(run(Code::NotAnd), ~acc & a);
  EXPECT_EQ(run(Code::Or), acc | a);
  EXPECT_EQ(run(Code::Xor), acc ^ a);
  EXPECT_EQ(run(Code::MuxHigh), (a & acc) | (~a & b));
  EXPECT_EQ(run(Code::MuxNotHigh), (a & ~acc) | (~a & b));
  EXPECT_EQ(run(Code::MuxLow), (a & b) | (~a & acc));
  EXPECT_EQ(run(Code::MuxLowNot), (a & ~b) | (~a & acc));
}

}  // namespace
}  // namespace thimble::sim::cam
