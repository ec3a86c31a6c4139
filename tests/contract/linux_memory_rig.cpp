// What the machine does with a window, under the contract suite: a file in memory stands for the
// BAR, the test has the board's end as bytes of the file, and cuts it where a board is pulled out.
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>

#include "hal/linux/mapped_window.hpp"
#include "tests/contract/memory_window_contract.hpp"

namespace thimble::test {
namespace {

using linux::Descriptor;
using linux::MappedWindow;

Descriptor file_of(std::size_t bytes) {
  Descriptor file(::memfd_create("bar", MFD_CLOEXEC));
  EXPECT_EQ(::ftruncate(file.get(), static_cast<off_t>(bytes)), 0);
  return file;
}

class MappedRig final : public MemoryRig {
 public:
  bus::MemoryWindow& window() override { return *window_; }
  Bytes board_sees() override {
    Bytes bytes(kBytes);
    EXPECT_EQ(::pread(file_.get(), bytes.data(), bytes.size(), 0),
              static_cast<ssize_t>(bytes.size()));
    return bytes;
  }
  void board_puts(std::size_t offset, const Bytes& bytes) override {
    EXPECT_EQ(::pwrite(file_.get(), bytes.data(), bytes.size(), static_cast<off_t>(offset)),
              static_cast<ssize_t>(bytes.size()));
  }
  void unplug() override { EXPECT_EQ(::ftruncate(file_.get(), 0), 0); }

 private:
  Descriptor file_ = file_of(kBytes);
  std::unique_ptr<MappedWindow> window_ = MappedWindow::map(file_, "bar").value();
};

std::unique_ptr<MemoryRig> make() { return std::make_unique<MappedRig>(); }

INSTANTIATE_TEST_SUITE_P(Linux, MemoryWindowContract,
                         testing::Values(MemoryRigFactory{"MappedWindow", &make}), memory_rig_name);

TEST(MappedWindowTest, WhatIsNoWindowIsRefusedWithItsName) {
  for (const std::size_t bytes : {std::size_t{0}, std::size_t{4097}, std::size_t{4098}}) {
    const auto sut = MappedWindow::map(file_of(bytes), "/sys/…/resource2");
    ASSERT_FALSE(sut.has_value()) << bytes;
    EXPECT_EQ(sut.error().code, Errc::InvalidArgument);
    EXPECT_NE(sut.error().message.find("/sys/…/resource2"), std::string::npos);
  }
  const auto large = MappedWindow::map(file_of(linux::kMaxWindowBytes + 4096), "bar");
  ASSERT_FALSE(large.has_value());
  EXPECT_EQ(large.error().code, Errc::TooLarge);
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe(pipe.data()), 0);
  const Descriptor read_end(pipe[0]);
  const Descriptor write_end(pipe[1]);
  EXPECT_FALSE(MappedWindow::map(read_end, "pipe").has_value());
  EXPECT_FALSE(MappedWindow::map(Descriptor(), "closed").has_value());
}

TEST(MappedWindowTest, ANodeThatMayOnlyBeReadIsRefused) {
  const Descriptor file = file_of(4096);
  const Descriptor read_only(
      ::open(("/proc/self/fd/" + std::to_string(file.get())).c_str(), O_RDONLY | O_CLOEXEC));
  const auto sut = MappedWindow::map(read_only, "bar");
  ASSERT_FALSE(sut.has_value());
  EXPECT_EQ(sut.error().code, Errc::Permission);
}

TEST(MappedWindowTest, OneThatIsGoneTakesNoOtherWithIt) {
  const Descriptor first_file = file_of(4096);
  const Descriptor second_file = file_of(4096);
  const auto first = MappedWindow::map(first_file, "first").value();
  const auto second = MappedWindow::map(second_file, "second").value();
  ASSERT_EQ(::ftruncate(first_file.get(), 0), 0);
  std::uint32_t word = 0;
  EXPECT_EQ(first->read(0, word), IoStatus::Disconnected);
  EXPECT_EQ(second->write(0, 5), IoStatus::Ok);
  EXPECT_EQ(second->read(0, word), IoStatus::Ok);
  EXPECT_EQ(word, 5U);
}

// The zeros that then stand there are no words of the board.
TEST(MappedWindowTest, OfABlockDuringWhichItGoesAwayOnlyWhatWasReadBeforeIsGiven) {
  const Descriptor file = file_of(8192);
  const auto sut = MappedWindow::map(file, "bar").value();
  const std::array<std::uint32_t, 2> ours{5, 6};
  ASSERT_EQ(sut->write_block(4088, ours), IoStatus::Ok);
  ASSERT_EQ(::ftruncate(file.get(), 4096), 0);
  std::array<std::uint32_t, 4> words{1, 2, 3, 4};
  EXPECT_EQ(sut->read_block(4088, words), IoStatus::Disconnected);
  EXPECT_EQ(words, (std::array<std::uint32_t, 4>{5, 6, 3, 4}));
  EXPECT_EQ(sut->read_block(0, words), IoStatus::Disconnected);
  EXPECT_EQ(words, (std::array<std::uint32_t, 4>{5, 6, 3, 4}));
}

TEST(MappedWindowTest, TheNodeMayBeClosed) {
  std::unique_ptr<MappedWindow> sut;
  {
    const Descriptor file = file_of(4096);
    sut = MappedWindow::map(file, "bar").value();
  }
  EXPECT_EQ(sut->write(0, 9), IoStatus::Ok);
}

// In a process of its own: it ends, and by the signal.
TEST(MappedWindowDeathTest, ABusErrorOfSomebodyElseIsNotSwallowed) {
  const auto touch_what_is_gone = [] {
    const auto window = MappedWindow::map(file_of(4096), "bar").value();
    std::uint32_t word = 0;
    static_cast<void>(window->read(0, word));
    const Descriptor other = file_of(4096);
    auto* memory = static_cast<volatile char*>(
        ::mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, other.get(), 0));
    static_cast<void>(::ftruncate(other.get(), 0));
    memory[0] = 1;
  };
  testing::GTEST_FLAG(death_test_style) = "threadsafe";
  EXPECT_DEATH(touch_what_is_gone(), "");
}

}  // namespace
}  // namespace thimble::test
