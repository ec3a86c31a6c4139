#include "hal/linux/line_output.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <string>

namespace thimble::linux {
namespace {

// A pipe whose writing end waits when it is full, as a service's standard error does.
class LineOutputTest : public testing::Test {
 protected:
  LineOutputTest() {
    std::signal(SIGPIPE, SIG_IGN);
    EXPECT_EQ(::pipe(ends_.data()), 0);
  }
  ~LineOutputTest() override {
    close_reader();
    ::close(ends_[1]);
  }
  void close_reader() {
    if (ends_[0] >= 0) ::close(ends_[0]);
    ends_[0] = -1;
  }
  std::string read_all() {
    EXPECT_EQ(::fcntl(ends_[0], F_SETFL, O_NONBLOCK), 0);
    std::string out;
    std::array<char, 4096> bytes{};
    for (ssize_t n = 0; (n = ::read(ends_[0], bytes.data(), bytes.size())) > 0;) {
      out.append(bytes.data(), static_cast<std::size_t>(n));
    }
    return out;
  }
  // Would hang, not fail, if a write ever waited.
  std::uint64_t fill(LineOutput& sut) {
    std::uint64_t lines = 0;
    while (sut.lost() == 0) {
      sut.write("a line like any other\n");
      ++lines;
    }
    return lines - 1;
  }

  std::array<int, 2> ends_{-1, -1};
};

TEST_F(LineOutputTest, WritesLinesAsTheyAre) {
  LineOutput sut(ends_[1]);
  sut.write("warning: one\n");
  sut.write("warning: two\n");
  EXPECT_EQ(read_all(), "warning: one\nwarning: two\n");
  EXPECT_EQ(sut.lost(), 0U);
}

TEST_F(LineOutputTest, NeverWaitsForAReaderAndSaysHowManyLinesAreMissing) {
  LineOutput sut(ends_[1]);
  const std::uint64_t written = fill(sut);
  for (int i = 0; i < 9; ++i) sut.write("lost\n");
  EXPECT_EQ(sut.lost(), 10U);
  const std::string before = read_all();
  EXPECT_EQ(before.size(), written * 22);

  sut.write("heard again\n");

  EXPECT_EQ(read_all(), "(10 lines that nobody read are lost)\nheard again\n");
  EXPECT_EQ(sut.lost(), 10U);
}

TEST_F(LineOutputTest, CutsALineThatNoPipeTakesAtOnceAndStartsTheNextOnItsOwn) {
  LineOutput sut(ends_[1]);
  sut.write(std::string(10'000, 'x') + "\n");
  EXPECT_EQ(read_all(), std::string(LineOutput::kMostBytes, 'x'));
  sut.write("next\n");
  EXPECT_EQ(read_all(), "\nnext\n");
  EXPECT_EQ(sut.lost(), 0U);
}

TEST_F(LineOutputTest, AReaderThatIsGoneOrADescriptorThatIsNoneLosesLinesOnly) {
  LineOutput sut(ends_[1]);
  close_reader();
  sut.write("nobody\n");
  EXPECT_EQ(sut.lost(), 1U);
  LineOutput none(-1);
  none.write("nowhere\n");
  EXPECT_EQ(none.lost(), 1U);
}

}  // namespace
}  // namespace thimble::linux
