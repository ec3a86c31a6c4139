// A GPIO chip of this machine under its suite: the real libgpiod over the kernel's own driver of a
// CP2112, which hangs on uhid.
#include <fcntl.h>

#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "hal/linux/gpio_inventory.hpp"
#include "hal/linux/gpio_lines.hpp"
#include "sim/export/uhid_plug.hpp"
#include "sim/model/cp2112/cp2112_model.hpp"
#include "tests/contract/gpio_rig.hpp"
#include "tests/contract/kernel_cable.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;

constexpr const char* kDriversLabel = "cp2112_gpio";
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

class KernelGpioRig final : public GpioRig {
 public:
  Result<std::unique_ptr<bus::GpioLines>> open(const bus::GpioClaim& claim,
                                               rt::WakeSignal* wake) override {
    return chips_.open(claim, wake);
  }
  const char* label() const override { return kDriversLabel; }
  const char* name_of_line_2() const override { return "2"; }
  const char* name_of_line_5() const override { return "5"; }
  GpioRigLimits limits() const override {
    return {.why_no_edge_is_lost = "they are made of levels, and so in pairs",
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
    adapter_.set_wire(static_cast<unsigned>(line), is_high);
    clock_.sleep_until(clock_.now() + bus::kGpioReadPeriod + kWay);
  }
  bool wire(std::size_t line) const override { return adapter_.wire(line); }
  void lose_chip() override { adapter_.unplug(); }
  void restore_chip() override { adapter_.plug(); }
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
  bool is_hanging_{false};
  bool is_refusing_{false};
};

std::unique_ptr<GpioRig> make() { return std::make_unique<KernelGpioRig>(); }

INSTANTIATE_TEST_SUITE_P(Kernel, GpioLinesContract,
                         testing::Values(GpioRigFactory{"Cp2112", &make}), gpio_rig_name);

}  // namespace
}  // namespace thimble::test
