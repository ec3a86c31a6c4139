// What the real bus does with libgpiod, under the GPIO contract suite. In place of libgpiod and the
// kernel stands tests/support/fake_libgpiod.cpp, in place of the thread the test.
#include <fcntl.h>
#include <gpiod.h>

#include <algorithm>
#include <random>
#include <vector>

#include "hal/linux/event_fd.hpp"
#include "hal/linux/gpio_transfers.hpp"
#include "sim/time/virtual_clock.hpp"
#include "tests/contract/gpio_burst.hpp"
#include "tests/contract/gpio_rig.hpp"
#include "tests/support/fake_libgpiod.hpp"
#include "tests/support/temporary_folder.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;

const std::vector<std::string> kNames{"", "", "ESTOP-A", "", "", "ENABLE", "", ""};

class LinuxGpioRig : public GpioRig {
 public:
  explicit LinuxGpioRig(const char* label = kLabel)
      : chip_(folder_.path() / "gpiochip1", label, kNames) {}
  ~LinuxGpioRig() override { EXPECT_EQ(FakeGpioChip::alive(), 0) << "every chip must be closed"; }
  Result<std::unique_ptr<bus::GpioLines>> open(const bus::GpioClaim& claim,
                                               rt::WakeSignal* wake) override {
    auto lines = std::make_unique<Lines>(*this, claim, wake);
    auto transfers = linux::GpioTransfers::open(folder_.path(), claim, *lines, clock_);
    if (!transfers) return tl::unexpected(transfers.error());
    lines->transfers = *std::move(transfers);
    open_.push_back(lines.get());
    return lines;
  }
  void run_for(Duration duration) override {
    serve();
    for (Duration run{}; run < duration; run += milliseconds(1)) {
      clock_.run_for(milliseconds(1));
      serve();
    }
  }
  MonotonicTime now() const override { return clock_.now(); }
  void set_wire(std::size_t line, bool is_high) override { chip_.set_wire(line, is_high); }
  bool wire(std::size_t line) const override { return chip_.wire(line); }
  void lose_chip() override { chip_.unplug(); }
  void restore_chip() override { chip_.replug(); }
  void lose_line(std::size_t line) override { chip_.end_request(line); }
  void lose_edges(int edges) override { chip_.lose_next_edges(edges); }
  // In place of the thread it cannot wait; what is not answered ends as a refusal, seconds later.
  void hang(bool is_hanging) override { chip_.fail_transfers(is_hanging); }
  void refuse(bool is_refusing) override { chip_.fail_transfers(is_refusing); }

 private:
  struct Lines final : bus::GpioMailboxes {
    Lines(LinuxGpioRig& rig, const bus::GpioClaim& claim, rt::WakeSignal* wake)
        : GpioMailboxes(claim.inputs.size(), claim.outputs.size(), wake), owner(&rig) {}
    ~Lines() override { std::erase(owner->open_, this); }
    Lines(const Lines&) = delete;
    Lines& operator=(const Lines&) = delete;
    LinuxGpioRig* owner;
    std::unique_ptr<linux::GpioTransfers> transfers;
  };
  void serve() {
    for (Lines* lines : open_) lines->transfers->serve();
  }

  sim::VirtualClock clock_;
  testing_support::TemporaryFolder folder_;
  FakeGpioChip other_{folder_.path() / "gpiochip0", "other", {"a"}};
  FakeGpioChip chip_;
  std::vector<Lines*> open_;
};

// One whose edges are made of its levels.
class PolledGpioRig final : public LinuxGpioRig {
 public:
  PolledGpioRig() : LinuxGpioRig(kPolled) {}
  const char* label() const override { return kPolled; }
  GpioRigLimits limits() const override {
    return {.why_no_edge_is_lost = "they are made of levels, and so in pairs",
            .why_no_line_goes_alone = "nobody waits for the edges of one"};
  }
  void set_wire(std::size_t line, bool is_high) override {
    LinuxGpioRig::set_wire(line, is_high);
    run_for(bus::kGpioReadPeriod);
  }

 private:
  static constexpr const char* kPolled = "cp2112_gpio";
};

template <class Rig>
std::unique_ptr<GpioRig> make() {
  return std::make_unique<Rig>();
}

INSTANTIATE_TEST_SUITE_P(Linux, GpioLinesContract,
                         testing::Values(GpioRigFactory{"GpioTransfers", &make<LinuxGpioRig>},
                                         GpioRigFactory{"WithoutEdges", &make<PolledGpioRig>}),
                         gpio_rig_name);

struct GpioTransfersTest : testing::Test {
  sim::VirtualClock clock;
  testing_support::TemporaryFolder folder;
  bus::GpioMailboxes mail{1, 1, nullptr};
  bus::GpioClaim claim{"bench", {"2"}, {"5"}};

  Result<std::unique_ptr<linux::GpioTransfers>> open() {
    return linux::GpioTransfers::open(folder.path(), claim, mail, clock);
  }
  ~GpioTransfersTest() override { EXPECT_EQ(FakeGpioChip::alive(), 0); }
};

TEST_F(GpioTransfersTest, AChipThatMayNotBeOpenedIsNoObstacleOnTheWayToAnother) {
  FakeGpioChip first(folder.path() / "gpiochip0", "soc", kNames);
  FakeGpioChip second(folder.path() / "gpiochip7", "bench", kNames);
  first.forbid(true);
  EXPECT_TRUE(open().has_value());
  second.forbid(true);
  const auto refused = open();
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, Errc::Permission);
}

TEST_F(GpioTransfersTest, TwoChipsOfOneLabelAreRefusedInsteadOfGuessed) {
  FakeGpioChip first(folder.path() / "gpiochip0", "bench", kNames);
  FakeGpioChip second(folder.path() / "gpiochip1", "bench", kNames);
  EXPECT_EQ(open().error().code, Errc::InvalidArgument);
}

TEST_F(GpioTransfersTest, AnotherNameOfTheNodeIsNoSecondChip) {
  FakeGpioChip chip(folder.path() / "gpiochip0", "bench", kNames);
  std::filesystem::create_symlink("gpiochip0", folder.path() / "gpiochip4");
  EXPECT_TRUE(open().has_value());
}

TEST_F(GpioTransfersTest, AFolderThatIsNotThereHasNoChips) {
  const auto opened = linux::GpioTransfers::open(folder.path() / "none", claim, mail, clock);
  EXPECT_EQ(opened.error().code, Errc::NotFound);
}

TEST_F(GpioTransfersTest, ThePullIsAskedForOfTheInputs) {
  FakeGpioChip chip(folder.path() / "gpiochip0", "bench", kNames);
  claim.pull = bus::GpioPull::Up;
  EXPECT_TRUE(open().has_value());
  EXPECT_EQ(chip.flags(2), GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP);
  EXPECT_EQ(chip.flags(5), 0);
  claim.pull = bus::GpioPull::Down;
  EXPECT_TRUE(open().has_value());
  EXPECT_EQ(chip.flags(2), GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN);
}

// Nor waited for: its driver would read for them, and Linux 6.1 cannot end that.
TEST_F(GpioTransfersTest, NoEdgesAreAskedOfACp2112) {
  FakeGpioChip chip(folder.path() / "gpiochip0", "cp2112_gpio", kNames);
  claim.chip = "cp2112_gpio";
  const auto sut = open().value();
  EXPECT_FALSE(chip.is_told_of_edges(2));
  bus::GpioEdge edge;
  for (const bool is_high : {true, false, false, true}) {
    chip.set_wire(2, is_high);
    clock.run_for(bus::kGpioReadPeriod);
    sut->serve();
    if (mail.next_edge(edge) == IoStatus::Ok) {
      EXPECT_EQ(edge.arrived_at, clock.now());
    }
    EXPECT_EQ(edge.is_high, is_high);
  }
  EXPECT_EQ(edge.sequence, 3U);
  // A pulse between two readings is not seen: who has such a chip is told so.
  chip.set_wire(2, false);
  chip.set_wire(2, true);
  clock.run_for(bus::kGpioReadPeriod);
  sut->serve();
  EXPECT_EQ(mail.next_edge(edge), IoStatus::NoData);
}

// The edge is told, the levels grow old.
TEST_F(GpioTransfersTest, AnInputThatRefusesHidesNoEdgeOfAnother) {
  FakeGpioChip chip(folder.path() / "gpiochip0", "cp2112_gpio", kNames);
  claim = {"cp2112_gpio", {"2", "3", "4"}, {}};
  bus::GpioMailboxes three{3, 0, nullptr};
  const auto sut = linux::GpioTransfers::open(folder.path(), claim, three, clock).value();
  bus::GpioLevels before;
  ASSERT_EQ(three.levels(before), IoStatus::Ok);
  chip.fail_line(4, true);
  chip.set_wire(2, true);
  clock.run_for(bus::kGpioReadPeriod);
  sut->serve();
  bus::GpioEdge edge;
  ASSERT_EQ(three.next_edge(edge), IoStatus::Ok);
  EXPECT_EQ(edge.input, 0);
  EXPECT_TRUE(edge.is_high);
  bus::GpioLevels levels;
  ASSERT_EQ(three.levels(levels), IoStatus::Ok);
  EXPECT_EQ(levels, before);
  chip.fail_line(4, false);
  chip.set_wire(4, true);
  clock.run_for(bus::kGpioReadPeriod);
  sut->serve();
  ASSERT_EQ(three.next_edge(edge), IoStatus::Ok);
  EXPECT_EQ(edge.input, 2);
  ASSERT_EQ(three.levels(levels), IoStatus::Ok);
  EXPECT_EQ(levels.high, 5U);
}

TEST_F(GpioTransfersTest, TheOldestEdgesOfABurstAreKeptAndTheHoleIsSeen) {
  FakeGpioChip chip(folder.path() / "gpiochip0", "bench", kNames);
  const auto sut = open().value();
  const auto set_wire = [&](bool is_high) { chip.set_wire(2, is_high); };
  expect_full_queue_told(*sut, mail, set_wire);
  expect_next_edge_told_as_whole(*sut, mail, set_wire);
}

// Against the kernel's rule: what is left out of the numbers is one for a queue that was full, and
// one for two edges alike.
TEST_F(GpioTransfersTest, OnlyBurstsOfSixteenAndMoreLeaveAHole) {
  FakeGpioChip chip(folder.path() / "gpiochip0", "bench", kNames);
  const auto sut = open().value();
  std::mt19937 dice(7);
  bool is_high = false;
  bool is_one_between_lost = false;
  std::uint64_t told = 0;
  for (int round = 0; round < 400; ++round) {
    const int edges = round < 17 ? round : static_cast<int>(dice() % 24);
    for (int i = 0; i < edges; ++i) chip.set_wire(2, is_high = !is_high);
    sut->serve();
    const int kept = std::min(edges, 16);
    told += static_cast<std::uint64_t>(kept) + (edges >= 16 ? 1 : 0);
    if (is_one_between_lost && kept > 0) ++told;
    bus::GpioEdge edge{.sequence = told};
    for (int i = 0; i < kept; ++i) ASSERT_EQ(mail.next_edge(edge), IoStatus::Ok);
    ASSERT_EQ(edge.sequence, told) << edges << " edges in round " << round;
    ASSERT_EQ(mail.next_edge(edge), IoStatus::NoData);
    if (kept > 0) is_one_between_lost = (edges - kept) % 2 != 0;
  }
}

// Whenever within a reading a wire changes: who is first in the claim was asked last.
TEST_F(GpioTransfersTest, AReadingHasOfTheFirstInputWhatIsNewest) {
  FakeGpioChip chip(folder.path() / "gpiochip0", "bench", kNames);
  claim.inputs = {"2", "3", "4"};
  bus::GpioMailboxes three{3, 1, nullptr};
  const auto sut = linux::GpioTransfers::open(folder.path(), claim, three, clock).value();
  for (int questions = 1; questions <= 3; ++questions) {
    chip.set_wire(2, true);
    int left = questions;
    chip.before_answers([&](std::size_t) {
      if (--left == 0) chip.set_wire(2, false);
    });
    clock.run_for(bus::kGpioReadPeriod);
    sut->serve();
    chip.before_answers({});
    ASSERT_LE(left, 0) << "it was asked so often";
    bus::GpioLevels levels;
    ASSERT_EQ(three.levels(levels), IoStatus::Ok);
    EXPECT_FALSE(levels.is_high(0)) << questions;
  }
}

TEST_F(GpioTransfersTest, WaitingEndsWithTheNextLevelsAndWithAWake) {
  FakeGpioChip chip(folder.path() / "gpiochip0", "bench", kNames);
  const auto sut = open().value();
  const auto wake = linux::EventFd::create().value();
  clock.run_for(bus::kGpioReadPeriod);
  sut->wait(wake->fd());  // would wait for ever if it waited at all: time stands still
  sut->serve();
  wake->signal();
  sut->wait(wake->fd());
  wake->drain();
  chip.set_wire(2, true);
  sut->wait(wake->fd());
  sut->serve();
  bus::GpioEdge edge;
  EXPECT_EQ(mail.next_edge(edge), IoStatus::Ok);
}

}  // namespace
}  // namespace thimble::test
