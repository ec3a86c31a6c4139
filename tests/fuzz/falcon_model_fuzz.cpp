#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "sim/model/falcon/falcon_arm_model.hpp"

// Any requests, packets and pauses from the host leave the simulated arm in one piece, its packets
// within their size and its motors within their range. The first byte says whether it has firmware.
// Then, again and again: one byte of what to do, one of rounds of 125 us before it, and for
//   0..1 mod 4  a packet: one byte of length, then its bytes
//   2 mod 4     a request: number, low and high byte of its value
//   3 mod 4     nothing but a look for a packet
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thimble;
  if (size == 0) return 0;
  sim::FalconArmModel arm(sim::falcon_parameters());
  if (data[0] % 2 != 0) arm.load_firmware();
  MonotonicTime now{};
  std::span<const std::uint8_t> rest(data + 1, size - 1);
  // 1 s of an arm is enough for one input.
  while (rest.size() >= 2 && now.since_epoch < std::chrono::seconds(1)) {
    const unsigned what = rest[0] % 4;
    now = now + rest[1] * std::chrono::microseconds(125);
    arm.advance(now);
    rest = rest.subspan(2);
    if (what < 2 && !rest.empty()) {
      const std::size_t length = std::min<std::size_t>(1 + rest[0] % 64, rest.size() - 1);
      if (length > 0) arm.out_packet(0x02, rest.subspan(1, length));
      rest = rest.subspan(1 + length);
    } else if (what == 2 && rest.size() >= 3) {
      std::array<std::uint8_t, 64> in{};
      const auto value = static_cast<std::uint16_t>(rest[1] | rest[2] << 8U);
      arm.control({.request_type = 0x40, .request = rest[0], .value = value}, in);
      rest = rest.subspan(3);
    }
    std::array<std::uint8_t, 64> in{};
    if (arm.in_packet(0x81, in).size > in.size()) std::abort();
    for (const int counts : arm.processor().motor_counts()) {
      if (std::abs(counts) > 4095) std::abort();
    }
    const plugin::ArmTruth truth = arm.truth();
    if (!is_finite(truth.tip) || !is_finite(truth.tip_velocity)) std::abort();
    if (norm(truth.tip - Position3{}) > 0.2 || arm.plant().standstills() > 0) std::abort();
  }
  return 0;
}
