#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "sim/model/arm/text_firmware.hpp"

// Any bytes from a host leave the board's currents within full scale, and its watchdog awake. The
// first byte says whether it wants its button pressed first. Each chunk: one byte of length, one of
// time to wait before it, in 2 ms, then its bytes; an odd time also reads what the board has to
// say.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thimble;
  constexpr double kFullScaleA = 6;
  constexpr Duration kUnit = std::chrono::milliseconds(2);
  if (size == 0) return 0;
  sim::TextFirmware board(
      {.build_number = 3, .full_scale_a = kFullScaleA, .is_calibration_wanted = data[0] % 2 != 0});
  const sim::EncoderTotals totals{1, -2, 3, 0, 0, 0};
  board.power_up({}, Duration{0}, totals);

  MonotonicTime now{};
  std::array<std::uint8_t, 512> said{};
  std::span<const std::uint8_t> rest(data + 1, size - 1);
  while (rest.size() >= 2) {
    const std::size_t length = std::min<std::size_t>(rest[0], rest.size() - 2);
    now = now + rest[1] * kUnit;
    board.run_until(now, totals);
    for (const double current_a : board.amplifier().current_a()) {
      if (!(std::abs(current_a) <= kFullScaleA)) std::abort();
    }
    if (rest[1] % 2 != 0 && board.give(said) > said.size()) std::abort();
    if (board.take(rest.subspan(2, length)) > length) std::abort();
    rest = rest.subspan(2 + length);
  }
  // Read to the end, so that nothing that waits is obeyed later.
  for (int i = 0; i < 200; ++i) {
    board.run_until(now, totals);
    static_cast<void>(board.give(said));
  }
  board.run_until(now + std::chrono::seconds(1), totals);
  if (board.amplifier().is_on()) std::abort();
  return 0;
}
