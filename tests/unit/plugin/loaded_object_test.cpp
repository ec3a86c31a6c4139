#include "hal/plugin/loaded_object.hpp"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <random>

namespace thimble::plugin {
namespace {

const void* at(std::uintptr_t place) { return reinterpret_cast<const void*>(place); }

// Byte by byte, over a small memory with holes.
TEST(LoadedObject, HasARangeOnlyIfOneSegmentHasEveryByteWithTheRight) {
  std::mt19937 random(2);
  int inside = 0;
  for (int round = 0; round < 20000; ++round) {
    std::vector<Segment> segments;
    for (std::uintptr_t place = 1 + random() % 4; place < 40; place += random() % 6) {
      const Segment segment{place, 1 + random() % 12, random() % 4 != 0, random() % 2 == 0};
      segments.push_back(segment);
      place += segment.bytes;
    }
    const std::uintptr_t first = random() % 50;
    const std::size_t bytes = random() % 10;
    const Access access = random() % 2 == 0 ? Access::Read : Access::Execute;
    bool is_in_one = false;
    for (const Segment& segment : segments) {
      std::size_t held = 0;
      for (std::uintptr_t i = first; i < first + bytes; ++i) {
        held += i >= segment.start && i < segment.start + segment.bytes ? 1U : 0U;
      }
      const bool is_allowed = access == Access::Read ? segment.is_readable : segment.is_executable;
      is_in_one = is_in_one || (is_allowed && bytes > 0 && held == bytes);
    }
    ASSERT_EQ(is_in(segments, at(first), bytes, access), is_in_one) << round;
    inside += is_in_one ? 1 : 0;
  }
  EXPECT_GT(inside, 1000);
}

TEST(LoadedObject, NoRangeGoesRoundTheEndOfTheMemory) {
  const std::vector<Segment> segments{{UINTPTR_MAX - 15, 15, true, true}, {0x1000, 16, true, true}};
  EXPECT_TRUE(is_in(segments, at(UINTPTR_MAX - 15), 15, Access::Read));
  EXPECT_FALSE(is_in(segments, at(UINTPTR_MAX - 1), 2, Access::Read));
  EXPECT_FALSE(is_in(segments, at(0x1008), SIZE_MAX, Access::Read));
  EXPECT_FALSE(is_in(segments, at(0x1008), SIZE_MAX - 0x1007, Access::Read));
}

const int kData = 7;

TEST(LoadedObject, TellsTheCodeOfThisProgramFromItsData) {
  void* self = dlopen(nullptr, RTLD_NOW);
  const link_map* object = nullptr;
  ASSERT_EQ(dlinfo(self, RTLD_DI_LINKMAP, &object), 0);
  const std::vector<Segment> sut = segments_of(*object);
  const auto* code = reinterpret_cast<const void*>(&at);
  EXPECT_TRUE(is_in(sut, code, 1, Access::Execute));
  EXPECT_TRUE(is_in(sut, &kData, sizeof(kData), Access::Read));
  EXPECT_FALSE(is_in(sut, &kData, sizeof(kData), Access::Execute));
  EXPECT_FALSE(is_in(sut, &object, 1, Access::Read)) << "the stack is not of the file";
  link_map foreign{};
  EXPECT_TRUE(segments_of(foreign).empty());
  dlclose(self);
}

}  // namespace
}  // namespace thimble::plugin
