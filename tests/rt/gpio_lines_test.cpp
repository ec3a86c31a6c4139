// linux::GpioChips and its lines with their thread, over the libgpiod of tests/support.
#include "hal/linux/gpio_lines.hpp"

#include <gtest/gtest.h>
#include <poll.h>

#include <memory>
#include <string>
#include <vector>

#include "hal/linux/event_fd.hpp"
#include "hal/linux/monotonic_clock.hpp"
#include "tests/rt/wait_until.hpp"
#include "tests/support/fake_libgpiod.hpp"
#include "tests/support/temporary_folder.hpp"

namespace thimble::linux {
namespace {

struct GpioLinesTest : testing::Test {
  MonotonicClock clock;
  testing_support::TemporaryFolder folder;
  test::FakeGpioChip chip{folder.path() / "gpiochip0", "bench", {"", "", "", ""}};
  std::unique_ptr<EventFd> wake = EventFd::create().value();
  GpioChips chips{BusSettings{clock, {}, {}}, folder.path()};

  ~GpioLinesTest() override { EXPECT_EQ(test::FakeGpioChip::alive(), 0); }
  std::unique_ptr<bus::GpioLines> open() {
    return chips.open({"bench", {"0", "1"}, {"3"}}, wake.get()).value();
  }
};

TEST_F(GpioLinesTest, AnEdgeWakesItsUserAndAnOutputReachesItsWire) {
  const auto sut = open();
  wake->drain();
  bus::GpioEdge edge;
  for (std::uint64_t i = 1; i <= 20; ++i) {
    chip.set_wire(1, i % 2 != 0);
    pollfd watched{wake->fd(), POLLIN, 0};
    ASSERT_EQ(::poll(&watched, 1, -1), 1);
    wake->drain();
    ASSERT_TRUE(test::wait_until([&] { return sut->next_edge(edge) == IoStatus::Ok; }));
    EXPECT_EQ(edge.sequence, i);
    sut->set(0, i % 2 != 0);
    EXPECT_TRUE(test::wait_until([&] { return chip.wire(3) == (i % 2 != 0); }));
  }
}

TEST_F(GpioLinesTest, OutputsAreLowWhenItIsClosed) {
  auto sut = open();
  sut->set(0, true);
  EXPECT_TRUE(test::wait_until([&] { return chip.wire(3); }));
  sut.reset();
  EXPECT_FALSE(chip.wire(3));
}

TEST_F(GpioLinesTest, AChipThatIsPulledOutIsFoundOutWithoutAnEdge) {
  const auto sut = open();
  chip.unplug();
  bus::GpioLevels levels;
  EXPECT_TRUE(test::wait_until([&] { return sut->levels(levels) == IoStatus::Disconnected; }));
  chip.replug();
  EXPECT_EQ(open()->levels(levels), IoStatus::Ok);
}

TEST_F(GpioLinesTest, ARefusedClaimLeavesNothingOpen) {
  EXPECT_EQ(chips.open({"bench", {"9"}, {}}, nullptr).error().code, Errc::NotFound);
  EXPECT_EQ(chips.open({"desk", {"0"}, {}}, nullptr).error().code, Errc::NotFound);
  EXPECT_EQ(test::FakeGpioChip::alive(), 0);
}

}  // namespace
}  // namespace thimble::linux
