#include "hal/linux/descriptor.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>

#include <array>
#include <utility>

namespace thimble::linux {
namespace {

bool is_open(int fd) { return ::fcntl(fd, F_GETFD) >= 0; }

struct DescriptorTest : testing::Test {
  std::array<int, 2> ends{-1, -1};
  DescriptorTest() { EXPECT_EQ(::pipe(ends.data()), 0); }
};

TEST_F(DescriptorTest, ClosesItsFileWhenItEnds) {
  { const Descriptor sut(ends[0]); }
  EXPECT_FALSE(is_open(ends[0]));
  const Descriptor other(ends[1]);
  EXPECT_TRUE(is_open(ends[1]));
}

TEST_F(DescriptorTest, WhatIsAssignedToItClosesWhatItHadAtOnce) {
  Descriptor sut(ends[0]);
  Descriptor other(ends[1]);
  sut = std::move(other);
  EXPECT_FALSE(is_open(ends[0])) << "not with the one that was moved from";
  EXPECT_EQ(sut.get(), ends[1]);
  EXPECT_TRUE(is_open(ends[1]));
}

TEST_F(DescriptorTest, ToItselfItStays) {
  const Descriptor other(ends[1]);
  Descriptor sut(ends[0]);
  Descriptor& same = sut;
  sut = std::move(same);
  EXPECT_EQ(sut.get(), ends[0]);
  EXPECT_TRUE(is_open(ends[0]));
}

}  // namespace
}  // namespace thimble::linux
