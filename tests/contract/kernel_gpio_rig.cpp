// A GPIO chip of this machine under its suite: the real libgpiod over the kernel's own driver of a
// CP2112, which hangs on uhid. And what only this driver and this kernel do.
#include <fcntl.h>
#include <gpiod.h>

#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "hal/bus/gpio_mailboxes.hpp"
#include "hal/linux/gpio_inventory.hpp"
#include "hal/linux/gpio_lines.hpp"
#include "hal/linux/gpio_transfers.hpp"
#include "hal/linux/gpiod_chip.hpp"
#include "sim/export/uhid_plug.hpp"
#include "sim/model/cp2112/cp2112_model.hpp"
#include "tests/contract/gpio_burst.hpp"
#include "tests/contract/gpio_rig.hpp"
#include "tests/contract/kernel_cable.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;

constexpr const char* kDriversLabel = "cp2112_gpio";
constexpr unsigned kWatched = 6;  // a line that no claim of the suite has
// A level that is read every kGpioReadPeriod, and a few requests to the device.
constexpr Duration kWay = milliseconds(30);

std::optional<std::string> find_chip() {
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/dev", ignored)) {
    if (!entry.path().filename().string().starts_with("gpiochip")) continue;
    const auto chip = linux::read_gpio_chip(entry.path().string());
    if (chip && chip->label == kDriversLabel) return chip->node;
  }
  return std::nullopt;
}

// The adapter, and the wires on it. It does nothing that nobody asks it for.
class Adapter {
 public:
  explicit Adapter(KernelCable& cable) : cable_(&cable) {
    linux::Descriptor node(::open("/dev/uhid", O_RDWR | O_CLOEXEC | O_NONBLOCK));
    const int kernel = node.get();
    plug_.emplace(std::move(node), model_, model_.describe(), cable.surroundings());
    cable.start({}, kernel);
    plug();
  }
  // The next test's chip must not be taken for this one.
  ~Adapter() {
    if (cable_->alone([this] { return plug_->is_plugged(); })) unplug();
    cable_->stop();
  }
  Adapter(const Adapter&) = delete;
  Adapter& operator=(const Adapter&) = delete;

  void plug() {
    cable_->alone([this] { EXPECT_TRUE(plug_->plug().has_value()); });
    EXPECT_TRUE(cable_->comes_true([] { return find_chip().has_value(); }));
  }
  void unplug() {
    cable_->alone([this] { EXPECT_TRUE(plug_->unplug(sim::Supply::Goes).has_value()); });
    EXPECT_TRUE(cable_->comes_true([] { return !find_chip().has_value(); }));
  }
  void set_wire(unsigned line, bool is_high) {
    cable_->alone([&] { EXPECT_TRUE(model_.press(line, is_high)); });
  }
  [[nodiscard]] bool wire(std::size_t line) const {
    return cable_->alone([&] { return model_.level(line); });
  }
  void refuse(bool is_refusing) {
    const MonotonicTime until{is_refusing ? Duration::max() : Duration::zero()};
    cable_->alone([&] { cable_->surroundings().misbehaviour->stall_until(until); });
  }

 private:
  KernelCable* cable_;
  sim::Cp2112Model model_;
  std::optional<sim::UhidPlug> plug_;
};

// The driver looks at all lines at once, every 40 ms (hid-cp2112.c, Linux 6.1) while somebody waits
// for an edge, and tells of none what it does not see then. One that we hold ourselves moves with
// each of the others: its edge says that the driver has looked, at those before it, too.
class WatchedWires {
 public:
  explicit WatchedWires(Adapter& adapter)
      : adapter_(&adapter), chip_(::gpiod_chip_open(find_chip().value_or("").c_str())) {
    line_ = chip_ ? ::gpiod_chip_get_line(chip_.get(), kWatched) : nullptr;
    EXPECT_NE(line_, nullptr);
    EXPECT_EQ(::gpiod_line_request_both_edges_events(line_, "contract"), 0);
  }
  ~WatchedWires() { adapter_->set_wire(kWatched, false); }
  WatchedWires(const WatchedWires&) = delete;
  WatchedWires& operator=(const WatchedWires&) = delete;

  void set(unsigned line, bool is_high) {
    adapter_->set_wire(line, is_high);
    adapter_->set_wire(kWatched, is_high_ = !is_high_);
    constexpr timespec kMost{20, 0};
    ASSERT_EQ(::gpiod_line_event_wait(line_, &kMost), 1);
    gpiod_line_event event{};
    EXPECT_EQ(::gpiod_line_event_read(line_, &event), 0);
  }

 private:
  Adapter* adapter_;
  linux::GpiodChip chip_;
  gpiod_line* line_;
  bool is_high_{false};
};

class KernelGpioRig final : public GpioRig {
 public:
  KernelGpioRig() { wires_.emplace(adapter_); }
  Result<std::unique_ptr<bus::GpioLines>> open(const bus::GpioClaim& claim,
                                               rt::WakeSignal* wake) override {
    return chips_.open(claim, wake);
  }
  const char* label() const override { return kDriversLabel; }
  const char* name_of_line_2() const override { return "2"; }
  const char* name_of_line_5() const override { return "5"; }
  GpioRigLimits limits() const override {
    return {.why_no_edge_is_lost =
                "the driver makes edges of levels, and so in pairs; what the "
                "kernel's queue loses is in KernelGpio",
            .why_no_line_goes_alone = "a kernel takes the whole chip away",
            .slowest_edge = milliseconds(100),
            .random_lives = 1};
  }
  void run_for(Duration duration) override {
    if (!is_hanging_) cable_.hold(false);
    if (!is_refusing_) adapter_.refuse(false);
    clock_.sleep_until(clock_.now() + duration + kWay);
  }
  MonotonicTime now() const override { return clock_.now(); }
  void set_wire(std::size_t line, bool is_high) override {
    wires_->set(static_cast<unsigned>(line), is_high);
  }
  bool wire(std::size_t line) const override { return adapter_.wire(line); }
  void lose_chip() override {
    wires_.reset();
    adapter_.unplug();
  }
  void restore_chip() override {
    adapter_.plug();
    wires_.emplace(adapter_);
  }
  void lose_line(std::size_t) override { ADD_FAILURE() << limits().why_no_line_goes_alone; }
  void lose_edges(int) override { ADD_FAILURE() << limits().why_no_edge_is_lost; }
  void hang(bool is_hanging) override {
    is_hanging_ = is_hanging;
    if (is_hanging) cable_.hold(true);
  }
  void refuse(bool is_refusing) override {
    is_refusing_ = is_refusing;
    if (is_refusing) adapter_.refuse(true);
  }

 private:
  linux::MonotonicClock clock_;
  linux::GpioChips chips_{linux::BusSettings{clock_, {}, {}}};
  KernelCable cable_{milliseconds(1)};
  Adapter adapter_{cable_};
  std::optional<WatchedWires> wires_;
  bool is_hanging_{false};
  bool is_refusing_{false};
};

std::unique_ptr<GpioRig> make() { return std::make_unique<KernelGpioRig>(); }

INSTANTIATE_TEST_SUITE_P(Kernel, GpioLinesContract,
                         testing::Values(GpioRigFactory{"Cp2112", &make}), gpio_rig_name);

// In place of the lines' thread the test.
struct KernelGpio : testing::Test {
  linux::MonotonicClock clock;
  KernelCable cable{milliseconds(1)};
  Adapter adapter{cable};
  bus::GpioMailboxes mail{1, 0, nullptr};

  std::unique_ptr<linux::GpioTransfers> open() {
    return linux::GpioTransfers::open("/dev", {kDriversLabel, {"0"}, {}}, mail, clock).value();
  }
  bool is_level_high() {
    bus::GpioLevels levels;
    EXPECT_EQ(mail.levels(levels), IoStatus::Ok);
    return levels.is_high(0);
  }
};

TEST_F(KernelGpio, OfEdgesThatNobodyReadsSixteenAreKeptAndTheHoleIsSeen) {
  WatchedWires wires(adapter);
  const auto sut = open();
  const auto set_wire = [&](bool is_high) { wires.set(0, is_high); };
  expect_full_queue_told(*sut, mail, set_wire);
  expect_next_edge_told_as_whole(*sut, mail, set_wire);
}

TEST_F(KernelGpio, ALineThatIsHighWhenTheDriverFirstLooksIsToldAsIfItRoseThen) {
  adapter.set_wire(0, true);
  const auto sut = open();
  EXPECT_TRUE(is_level_high()) << "as soon as it is open";
  bus::GpioEdge edge;
  EXPECT_TRUE(cable.comes_true([&] {
    sut->serve();
    return mail.next_edge(edge) == IoStatus::Ok;
  }));
  EXPECT_TRUE(edge.is_high);
  EXPECT_EQ(edge.sequence, 1U);
}

}  // namespace
}  // namespace thimble::test
