#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "sim/model/cp2112/cp2112_model.hpp"

// Any reports that a host asks for or sends leave the simulated adapter in one piece: what it
// answers is no longer than there is room for and bears the number that was asked for, and an input
// shows its wire whatever was written. Again and again: one byte of what to do, one of how much,
// and that many bytes.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thimble;
  using plugin::HidReportKind;
  sim::Cp2112Model chip;
  std::span<const std::uint8_t> rest(data, size);
  while (rest.size() >= 2) {
    const unsigned what = rest[0];
    const std::size_t length = std::min<std::size_t>(rest[1] % 70, rest.size() - 2);
    const auto bytes = rest.subspan(2, length);
    rest = rest.subspan(2 + length);
    const auto kind = static_cast<HidReportKind>(what / 4 % 3);
    if (what % 4 == 0) chip.press(what / 4 % 16, what >= 128);
    if (what % 4 == 1) static_cast<void>(chip.set_report(kind, bytes));
    if (what == 2) chip.power_cycle();
    std::array<std::uint8_t, 70> out{};
    const auto number = static_cast<std::uint8_t>(what);
    const std::size_t given = chip.get_report(kind, number, std::span(out).first(length));
    if (given > length || (given > 0 && out[0] != number)) std::abort();
  }
  // Inputs all: what is read is what the wires are.
  const std::array<std::uint8_t, 5> inputs{sim::Cp2112Model::kGpioConfig, 0, 0, 0, 0};
  if (!chip.set_report(HidReportKind::Feature, inputs)) std::abort();
  for (unsigned line = 0; line < sim::Cp2112Model::kLines; ++line) {
    for (const bool is_open : {true, false}) {
      if (!chip.press(line, is_open) || chip.level(line) != is_open) std::abort();
    }
  }
  return 0;
}
