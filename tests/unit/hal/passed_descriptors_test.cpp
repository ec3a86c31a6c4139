#include "hal/linux/passed_descriptors.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <vector>

#include "tests/support/passed_packet.hpp"

namespace thimble::linux {
namespace {

constexpr Duration kPatience = std::chrono::seconds(20);

struct Connection {
  Descriptor theirs;
  Descriptor ours;

  Connection() {
    std::array<int, 2> ends{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()), 0);
    theirs = Descriptor(ends[0]);
    ours = Descriptor(ends[1]);
  }
};

bool is_same_file(int one, int other) {
  struct stat first {};
  struct stat second {};
  return ::fstat(one, &first) == 0 && ::fstat(other, &second) == 0 &&
         first.st_ino == second.st_ino && first.st_dev == second.st_dev;
}

TEST(PassedDescriptors, OneOpenFileArrivesAndIsNotHandedToChildren) {
  Connection sut;
  const Descriptor file(::open("/proc/self/exe", O_RDONLY | O_CLOEXEC));
  ASSERT_TRUE(send_descriptor(sut.theirs.get(), file));
  const auto received = receive_descriptor(sut.ours.get(), kPatience);
  ASSERT_TRUE(received) << received.error().message;
  EXPECT_TRUE(is_same_file(received->get(), file.get()));
  EXPECT_EQ(::fcntl(received->get(), F_GETFD), FD_CLOEXEC);
}

// Whatever is sent: one byte with one file is taken, all else refused by its name, and no file of
// it stays open.
TEST(PassedDescriptors, AnyPacketWithAnyNumberOfFilesIsJudgedAndNoneStaysOpen) {
  for (std::size_t bytes = 0; bytes <= 4096; bytes = bytes < 3 ? bytes + 1 : bytes * 8) {
    for (std::size_t files = 0; files <= test::kMostPassed; ++files) {
      SCOPED_TRACE(testing::Message() << bytes << " bytes, " << files << " files");
      Connection sut;
      test::send_packet(sut.theirs.get(), std::vector<std::uint8_t>(bytes, 'x'), files);
      const int free_before = test::lowest_free();
      {
        const auto received = receive_descriptor(sut.ours.get(), kPatience);
        const bool is_one = bytes == 1 && files == 1;
        ASSERT_EQ(received.has_value(), is_one);
        if (!is_one) {
          const bool is_nothing = bytes == 0 && files == 0;
          EXPECT_EQ(received.error().code, is_nothing ? Errc::Disconnected : Errc::Malformed);
        }
      }
      EXPECT_EQ(test::lowest_free(), free_before);
    }
  }
}

TEST(PassedDescriptors, OnePacketIsTakenAtATime) {
  Connection sut;
  const std::vector<std::uint8_t> one{'x'};
  test::send_packet(sut.theirs.get(), one, 1);
  test::send_packet(sut.theirs.get(), one, 2);
  test::send_packet(sut.theirs.get(), one, 1);
  EXPECT_TRUE(receive_descriptor(sut.ours.get(), kPatience));
  EXPECT_EQ(receive_descriptor(sut.ours.get(), kPatience).error().code, Errc::Malformed);
  EXPECT_TRUE(receive_descriptor(sut.ours.get(), kPatience));
}

TEST(PassedDescriptors, WhoClosedIsSaidToBeGone) {
  Connection sut;
  sut.theirs = Descriptor();
  EXPECT_EQ(receive_descriptor(sut.ours.get(), kPatience).error().code, Errc::Disconnected);
}

// To poll(2) -1 ms is for ever: this would not end.
TEST(PassedDescriptors, NoPatienceAndLessIsNoWaitAtAll) {
  const Connection sut;
  for (const auto patience : {Duration::zero(), Duration(-1), Duration(std::chrono::seconds(-1))}) {
    EXPECT_EQ(receive_descriptor(sut.ours.get(), patience).error().code, Errc::Timeout);
  }
}

TEST(PassedDescriptors, WhatIsNoSocketIsRefused) {
  const Descriptor file(::open("/dev/null", O_RDWR | O_CLOEXEC));
  EXPECT_EQ(receive_descriptor(file.get(), kPatience).error().code, Errc::System);
  EXPECT_EQ(receive_descriptor(-1, Duration::zero()).error().code, Errc::Timeout);
  EXPECT_EQ(send_descriptor(file.get(), file).error().code, Errc::System);
}

}  // namespace
}  // namespace thimble::linux
