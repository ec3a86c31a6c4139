#pragma once

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <ostream>
#include <string>

#include "hal/bus/gpio_lines.hpp"

namespace thimble::test {

// What a chip can be made to do by whoever holds its wires. One that cannot says why, for a person.
struct GpioRigLimits {
  const char* why_no_edge_is_lost{nullptr};     // nullptr: lose_edges() loses some
  const char* why_no_line_goes_alone{nullptr};  // nullptr: lose_line() takes it away
  // nullptr: hang() and refuse() have it answer nothing
  const char* why_it_always_answers{nullptr};
  const char* why_it_stays{nullptr};  // nullptr: lose_chip() pulls it out, whoever has its lines
  Duration slowest_edge{2 * bus::kGpioReadPeriod};
  unsigned random_lives{20};  // fewer where time is real
};

// One implementation of bus::GpioChips with a chip of eight lines and their wires. Over a real
// kernel run_for() waits instead of running a virtual clock.
class GpioRig {
 public:
  static constexpr const char* kLabel = "bench";
  static constexpr std::size_t kLines = 8;

  virtual ~GpioRig() = default;
  [[nodiscard]] virtual Result<std::unique_ptr<bus::GpioLines>> open(const bus::GpioClaim& claim,
                                                                     rt::WakeSignal* wake) = 0;
  [[nodiscard]] virtual const char* label() const { return kLabel; }
  // What lines 2 and 5 are called; their places, where the chip names none. The others have no
  // name.
  [[nodiscard]] virtual const char* name_of_line_2() const { return "ESTOP-A"; }
  [[nodiscard]] virtual const char* name_of_line_5() const { return "ENABLE"; }
  [[nodiscard]] virtual GpioRigLimits limits() const { return {}; }

  virtual void run_for(Duration duration) = 0;
  [[nodiscard]] virtual MonotonicTime now() const = 0;
  // Returns when a wire that moves next is not moved too soon for this one to be seen.
  virtual void set_wire(std::size_t line, bool is_high) = 0;
  [[nodiscard]] virtual bool wire(std::size_t line) const = 0;
  virtual void lose_chip() = 0;
  virtual void restore_chip() = 0;
  virtual void lose_line(std::size_t line) = 0;
  virtual void lose_edges(int edges) = 0;
  // Answers nothing from now on; again from the next run_for() on.
  virtual void hang(bool is_hanging) = 0;
  // The same, but that it refuses what it is asked for.
  virtual void refuse(bool is_refusing) = 0;
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

  // Inputs 0: line 0, 1: line 2, by its name; outputs 0: line 4, 1: line 5, by its name.
  static constexpr std::array<std::size_t, 2> kInputLines{0, 2};
  static constexpr std::array<std::size_t, 2> kOutputLines{4, 5};
  [[nodiscard]] bus::GpioClaim claim() const {
    return {rig->label(), {"0", rig->name_of_line_2()}, {"4", rig->name_of_line_5()}};
  }
  [[nodiscard]] std::unique_ptr<bus::GpioLines> open() {
    return rig->open(claim(), nullptr).value();
  }
  // Until what happened on the wires is told.
  void settle() { rig->run_for(2 * bus::kGpioReadPeriod); }
  void expect_gone(bus::GpioLines& lines);
  // Of a chip that answers nothing of use while `mute` is on.
  void expect_age_and_backlog(void (GpioRig::*mute)(bool));
};

inline std::string gpio_rig_name(const testing::TestParamInfo<GpioRigFactory>& rig) {
  return rig.param.name;
}

}  // namespace thimble::test
