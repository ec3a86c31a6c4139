#include "hal/linux/hiddev.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/fake_hid_kernel.hpp"

namespace thimble::linux {
namespace {

using test::FakeHidKernel;
using Bytes = std::vector<std::uint8_t>;

constexpr int kNode = 7;

TEST(Hiddev, AReportOfOneFieldOfBytesIsTakenAsItIs) {
  FakeHidKernel kernel;
  for (const std::uint32_t bytes : {1U, 14U, 64U, 1024U}) {
    kernel.fields = {{bytes}};
    EXPECT_TRUE(takes_plain_bytes(kNode, bytes, kernel)) << bytes;
    EXPECT_FALSE(takes_plain_bytes(kNode, bytes + 1, kernel)) << bytes;
    EXPECT_FALSE(takes_plain_bytes(kNode, bytes - 1, kernel)) << bytes;
  }
  EXPECT_TRUE(kernel.sent.empty()) << "to ask sends nothing";
}

TEST(Hiddev, ANodeOfAnythingElseIsNoWayOut) {
  FakeHidKernel kernel;
  const auto is_taken = [&] { return takes_plain_bytes(kNode, 2, kernel); };
  ASSERT_TRUE(is_taken());
  kernel.fields = {{1}, {1}};
  EXPECT_FALSE(is_taken()) << "two fields";
  kernel.fields = {{2, -128, 127}};
  EXPECT_FALSE(is_taken()) << "signed";
  kernel.fields = {{2, 0, 1}};
  EXPECT_FALSE(is_taken()) << "bits";
  kernel.fields = {{2, 0, 65'535}};
  EXPECT_FALSE(is_taken()) << "words";
  kernel.fields = {};
  EXPECT_FALSE(is_taken()) << "takes no report";
  kernel.fields = {{2}};
  kernel.report_number = 1;
  EXPECT_FALSE(is_taken()) << "numbered";
  kernel.report_number = 0;
  kernel.has_hiddev = false;
  EXPECT_FALSE(is_taken()) << "no hiddev";
}

TEST(Hiddev, WhatIsSentIsWhatWasGivenTimeAndAgain) {
  std::mt19937 random(3);
  for (int round = 0; round < 200; ++round) {
    Bytes bytes(1 + random() % 64);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    FakeHidKernel kernel;
    kernel.fields = {{static_cast<std::uint32_t>(bytes.size())}};
    HiddevOutput sut(kNode, kernel);
    const Bytes others(bytes.rbegin(), bytes.rend());
    EXPECT_TRUE(sut.write(bytes));
    EXPECT_TRUE(sut.write(bytes));
    EXPECT_TRUE(sut.write(others));
    EXPECT_EQ(kernel.sent, (std::vector<FakeHidKernel::Report>{
                               {"dev", bytes}, {"dev", bytes}, {"dev", others}}));
  }
}

TEST(Hiddev, ToLookAtADeviceAsksItForNothingUntilThatIsWanted) {
  FakeHidKernel kernel;
  EXPECT_TRUE(takes_plain_bytes(kNode, 2, kernel));
  EXPECT_FALSE(kernel.is_initialized);
  have_reports_asked_for(kNode, kernel);
  EXPECT_TRUE(kernel.is_initialized);
  EXPECT_TRUE(kernel.sent.empty());
}

TEST(Hiddev, OfAReportThatIsTooLongTheRestIsLeftOut) {
  FakeHidKernel kernel;
  kernel.fields = {{HiddevOutput::kMaxBytes}};
  Bytes bytes(HiddevOutput::kMaxBytes + 1, 9);
  HiddevOutput sut(kNode, kernel);
  EXPECT_TRUE(sut.write(bytes));
  bytes.pop_back();
  EXPECT_EQ(kernel.sent, (std::vector<FakeHidKernel::Report>{{"dev", bytes}}));
}

TEST(Hiddev, OfADeviceThatIsGoneNothingIsSent) {
  FakeHidKernel kernel;
  kernel.is_unplugged = true;
  HiddevOutput sut(kNode, kernel);
  EXPECT_FALSE(sut.write(Bytes{1, 2}));
  kernel.is_unplugged = false;
  kernel.fields = {{1}};
  EXPECT_FALSE(sut.write(Bytes{1, 2})) << "shorter than the report";
  EXPECT_TRUE(kernel.sent.empty());
}

}  // namespace
}  // namespace thimble::linux
