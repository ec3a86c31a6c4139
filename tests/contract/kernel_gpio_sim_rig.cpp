// A GPIO chip whose kernel driver tells edges, under its suite: the real libgpiod over gpio-sim.
#include <algorithm>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "hal/linux/gpio_lines.hpp"
#include "hal/linux/gpio_transfers.hpp"
#include "hal/linux/monotonic_clock.hpp"
#include "tests/contract/gpio_burst.hpp"
#include "tests/contract/gpio_rig.hpp"
#include "tests/contract/gpio_sim_chip.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;

const std::vector<std::string> kLineNames{"", "", "ESTOP-A", "", "", "ENABLE", "", ""};
// The thread of the kernel's interrupt, that of the lines, and this one on one processor.
constexpr Duration kTurn = milliseconds(5);

class GpioSimRig final : public GpioRig {
 public:
  Result<std::unique_ptr<bus::GpioLines>> open(const bus::GpioClaim& claim,
                                               rt::WakeSignal* wake) override {
    return chips_.open(claim, wake);
  }
  GpioRigLimits limits() const override {
    return {.why_no_edge_is_lost = "the kernel loses none but behind sixteen: KernelGpio has those",
            .why_no_line_goes_alone = "a kernel takes the whole chip away",
            .why_it_always_answers = "it has no bus on which it could hang",
            .why_it_stays = "Linux 6.1 uses the interrupts of its lines after it has freed them",
            .random_lives = 1};
  }
  void run_for(Duration duration) override { clock_.sleep_until(clock_.now() + duration + kTurn); }
  MonotonicTime now() const override { return clock_.now(); }
  void set_wire(std::size_t line, bool is_high) override { chip_.set_wire(line, is_high); }
  bool wire(std::size_t line) const override { return chip_.wire(line); }
  void lose_chip() override { ADD_FAILURE() << limits().why_it_stays; }
  void restore_chip() override { ADD_FAILURE() << limits().why_it_stays; }
  void lose_line(std::size_t) override { ADD_FAILURE() << limits().why_no_line_goes_alone; }
  void lose_edges(int) override { ADD_FAILURE() << limits().why_no_edge_is_lost; }
  void hang(bool) override { ADD_FAILURE() << limits().why_it_always_answers; }
  void refuse(bool) override { ADD_FAILURE() << limits().why_it_always_answers; }

 private:
  linux::MonotonicClock clock_;
  linux::GpioChips chips_{linux::BusSettings{clock_, {}, {}}};
  GpioSimChip chip_{kLabel, kLineNames};
};

std::unique_ptr<GpioRig> make() { return std::make_unique<GpioSimRig>(); }

INSTANTIATE_TEST_SUITE_P(Kernel, GpioLinesContract,
                         testing::Values(GpioRigFactory{"GpioSim", &make}), gpio_rig_name);

// In place of the lines' thread the test.
struct KernelGpio : testing::Test {
  linux::MonotonicClock clock;
  GpioSimChip chip{"bench", kLineNames};
  bus::GpioMailboxes mail{1, 0, nullptr};
  std::unique_ptr<linux::GpioTransfers> sut =
      linux::GpioTransfers::open("/dev", {"bench", {"ESTOP-A"}, {}}, mail, clock).value();
  bool is_high{false};

  // Until the kernel's thread for it has noted the edge.
  void turn() {
    chip.set_wire(2, is_high = !is_high);
    clock.sleep_until(clock.now() + std::chrono::microseconds(500));
  }
};

TEST_F(KernelGpio, OfEdgesThatNobodyReadsSixteenAreKeptAndTheHoleIsSeen) {
  const auto set_wire = [&](bool is_rising) {
    EXPECT_NE(is_high, is_rising);
    turn();
  };
  expect_full_queue_told(*sut, mail, set_wire);
  expect_next_edge_told_as_whole(*sut, mail, set_wire);
}

#ifdef THIMBLE_KERNEL_NUMBERS_EDGES
// libgpiod 2: the sixteen newest are kept, and a number tells that others were there.
constexpr bool kNewestAreKept = true;
#else
// libgpiod 1.6: the sixteen oldest, and nobody knows of the others.
constexpr bool kNewestAreKept = false;
#endif

// What is left out of the numbers: by the rule that the stand-in for libgpiod 1.6 goes by
// (linux_gpio_rig.cpp), or by the kernel's numbers. Two edges alike say it once more.
class HoleRule {
 public:
  [[nodiscard]] std::uint64_t before(int edges) const {
    const bool is_hole = kNewestAreKept ? edges > 16 : edges >= 16;
    const bool is_alike =
        kNewestAreKept ? edges > 16 && edges % 2 != 0 : is_last_lost_ && edges > 0;
    return (is_hole ? 1U : 0U) + (is_alike ? 1U : 0U);
  }
  void passed(int edges) {
    if (edges > 0) is_last_lost_ = edges > 16 && edges % 2 != 0;
  }

 private:
  bool is_last_lost_{false};
};

TEST_F(KernelGpio, WhateverBurstsComeWhatIsKeptAndWhatIsMissedIsWhatTheRuleSays) {
  std::mt19937 dice(11);
  HoleRule rule;
  std::uint64_t told = 0;
  for (int round = 0; round < 60; ++round) {
    const int edges = static_cast<int>(dice() % 24);
    for (int i = 0; i < edges; ++i) turn();
    sut->serve();
    const int kept = std::min(edges, 16);
    told += static_cast<std::uint64_t>(kept) + rule.before(edges);
    rule.passed(edges);
    bus::GpioEdge edge{.sequence = told};
    for (int i = 0; i < kept; ++i) ASSERT_EQ(mail.next_edge(edge), IoStatus::Ok);
    ASSERT_EQ(edge.sequence, told) << edges << " edges in round " << round;
    ASSERT_EQ(mail.next_edge(edge), IoStatus::NoData);
  }
}

}  // namespace
}  // namespace thimble::test
