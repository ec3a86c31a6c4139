#pragma once

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <ostream>
#include <string>

#include "hal/bus/gpio_lines.hpp"

namespace thimble::test {

// One implementation of bus::GpioChips with a chip "bench" of eight lines and their wires. Line 2
// is called ESTOP-A, line 5 ENABLE, the others have no name.
class GpioRig {
 public:
  static constexpr const char* kLabel = "bench";
  static constexpr std::size_t kLines = 8;

  virtual ~GpioRig() = default;
  [[nodiscard]] virtual Result<std::unique_ptr<bus::GpioLines>> open(const bus::GpioClaim& claim,
                                                                     rt::WakeSignal* wake) = 0;
  virtual void run_for(Duration duration) = 0;
  [[nodiscard]] virtual MonotonicTime now() const = 0;
  virtual void set_wire(std::size_t line, bool is_high) = 0;
  [[nodiscard]] virtual bool wire(std::size_t line) const = 0;
  virtual void lose_chip() = 0;
  virtual void restore_chip() = 0;
  virtual void lose_line(std::size_t line) = 0;
  virtual void lose_edges(int edges) = 0;
  virtual void hang(bool is_hanging) = 0;
};

struct GpioRigFactory {
  std::string name;
  std::unique_ptr<GpioRig> (*make)();
  friend void PrintTo(const GpioRigFactory& factory, std::ostream* out) { *out << factory.name; }
};

// What every bus::GpioChips and its lines promise. An implementation joins with
// INSTANTIATE_TEST_SUITE_P(Name, GpioLinesContract, testing::Values(factory), gpio_rig_name).
class GpioLinesContract : public testing::TestWithParam<GpioRigFactory> {
 protected:
  std::unique_ptr<GpioRig> rig = GetParam().make();

  // Inputs 0: line 0, 1: line ESTOP-A; outputs 0: line 4, 1: line ENABLE.
  static constexpr std::array<std::size_t, 2> kInputLines{0, 2};
  static constexpr std::array<std::size_t, 2> kOutputLines{4, 5};
  [[nodiscard]] static bus::GpioClaim claim() {
    return {GpioRig::kLabel, {"0", "ESTOP-A"}, {"4", "ENABLE"}};
  }
  [[nodiscard]] std::unique_ptr<bus::GpioLines> open() {
    return rig->open(claim(), nullptr).value();
  }
  // Until what happened on the wires is told.
  void settle() { rig->run_for(2 * bus::kGpioReadPeriod); }
  void expect_gone(bus::GpioLines& lines);
};

inline std::string gpio_rig_name(const testing::TestParamInfo<GpioRigFactory>& rig) {
  return rig.param.name;
}

}  // namespace thimble::test
