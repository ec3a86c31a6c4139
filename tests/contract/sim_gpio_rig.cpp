// The simulated chip under the contract suite, and what only it can do.
#include "sim/bus/sim_gpio.hpp"
#include "sim/time/virtual_clock.hpp"
#include "tests/contract/gpio_rig.hpp"

namespace thimble::test {
namespace {

class SimGpioRig final : public GpioRig {
 public:
  Result<std::unique_ptr<bus::GpioLines>> open(const bus::GpioClaim& claim,
                                               rt::WakeSignal* wake) override {
    return chips_.open(claim, wake);
  }
  void run_for(Duration duration) override { clock_.run_for(duration); }
  MonotonicTime now() const override { return clock_.now(); }
  void set_wire(std::size_t line, bool is_high) override { chip_.set_level(line, is_high); }
  bool wire(std::size_t line) const override { return chip_.level(line); }
  void lose_chip() override { chip_.lose(); }
  void restore_chip() override { chip_.restore(); }
  void lose_line(std::size_t line) override { chip_.lose_line(line); }
  void lose_edges(int edges) override { chip_.lose_edges(edges); }
  void hang(bool is_hanging) override { chip_.hang(is_hanging); }
  void refuse(bool is_refusing) override { chip_.hang(is_refusing); }

 private:
  sim::VirtualClock clock_;
  sim::SimGpioChip chip_{clock_, kLabel, kLines, {"", "", "ESTOP-A", "", "", "ENABLE", "", ""}};
  sim::SimGpioChips chips_{{&chip_}};
};

std::unique_ptr<GpioRig> make() { return std::make_unique<SimGpioRig>(); }

INSTANTIATE_TEST_SUITE_P(Sim, GpioLinesContract, testing::Values(GpioRigFactory{"SimGpio", &make}),
                         gpio_rig_name);

struct SimGpioTest : testing::Test {
  sim::VirtualClock clock;
  sim::SimGpioChip chip{clock, "bench", 4};
  std::unique_ptr<bus::GpioLines> lines = chip.open({"bench", {"0", "1"}, {"3"}}, nullptr).value();

  int count_edges() const {
    int count = 0;
    bus::GpioEdge edge;
    while (lines->next_edge(edge) == IoStatus::Ok) ++count;
    return count;
  }
  bool level(std::size_t input) const {
    bus::GpioLevels levels;
    EXPECT_EQ(lines->levels(levels), IoStatus::Ok);
    return levels.is_high(input);
  }
};

TEST_F(SimGpioTest, AStuckWireTellsNothingUntilItIsFree) {
  chip.stick(0, true);
  chip.set_level(0, true);
  EXPECT_FALSE(level(0));
  EXPECT_EQ(count_edges(), 0);
  EXPECT_TRUE(chip.level(0));
  chip.stick(0, false);
  EXPECT_TRUE(level(0));
  EXPECT_EQ(count_edges(), 1);
}

TEST_F(SimGpioTest, AContactThatBouncesEndsWhereItWasGoing) {
  chip.bounce(1, true, 5);
  EXPECT_TRUE(level(1));
  EXPECT_EQ(count_edges(), 11);
  chip.bounce(1, false, 0);
  EXPECT_FALSE(level(1));
  EXPECT_EQ(count_edges(), 1);
}

TEST_F(SimGpioTest, ChangesOfAnOutputAreCounted) {
  for (int i = 0; i < 6; ++i) EXPECT_EQ(lines->set(0, i % 2 == 0), IoStatus::Ok);
  EXPECT_EQ(chip.changes(3), 6U);
}

TEST_F(SimGpioTest, AnOutputOfAChipThatHangsStaysAsItWasEvenWhenItIsClosed) {
  EXPECT_EQ(lines->set(0, true), IoStatus::Ok);
  chip.hang(true);
  lines.reset();
  EXPECT_TRUE(chip.level(3)) << "as many real ones do: the hardware must not trust a level";
}

}  // namespace
}  // namespace thimble::test
