#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "sim/model/arm/controller_firmware.hpp"

// Any sequence of host reports leaves the board's currents within full scale and its exchange in
// step. The first byte says which build of the board. Each report: one byte of length, one of
// frames to wait before it, then its bytes.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thimble;
  constexpr double kFullScaleA = 3;
  constexpr Duration kFrame{1'000'000};
  if (size == 0) return 0;
  const bool is_teensy = data[0] % 2 != 0;
  sim::ControllerFirmware board({.amplifier_max_a = kFullScaleA, .is_teensy = is_teensy});
  const sim::EncoderTotals totals{1, -2, 3, 0, 0, 0};
  board.power_up({}, Duration{0}, totals);

  MonotonicTime now{};
  std::span<const std::uint8_t> rest(data + 1, size - 1);
  while (rest.size() >= 2) {
    const std::size_t length = std::min<std::size_t>(rest[0], rest.size() - 2);
    now = now + (1 + 4 * rest[1]) * kFrame;
    board.run_until(now, totals);
    for (const double current_a : board.amplifier().current_a()) {
      if (!(std::abs(current_a) <= kFullScaleA)) std::abort();
    }
    board.out_report(now, rest.subspan(2, length));
    std::array<std::uint8_t, 64> in{};
    const std::size_t sent = board.in_report(now, in);
    if (sent != 0 && sent != board.report_bytes()) std::abort();
    rest = rest.subspan(2 + length);
  }
  board.run_until(now + 1000 * kFrame, totals);
  if (board.amplifier().is_on()) std::abort();  // half a second of silence
  return 0;
}
