#include "daemon/link/impairment.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

namespace thimble::link {
namespace {

struct Bound {
  std::string_view key;
  double value;
  double max;
};

}  // namespace

Result<void> validate(const ImpairmentSettings& settings) {
  const std::array<Bound, 5> bounds{{
      {"delay_s", settings.delay_s, ImpairmentSettings::kMaxDelay_s},
      {"jitter_s", settings.jitter_s, ImpairmentSettings::kMaxDelay_s},
      {"loss", settings.loss, 1.0},
      {"duplicate", settings.duplicate, 1.0},
      {"reorder", settings.reorder, 1.0},
  }};
  for (const Bound& bound : bounds) {
    if (bound.value >= 0 && bound.value <= bound.max) continue;  // NaN fails both
    return fail(Errc::InvalidArgument, std::string(bound.key) + " must be between 0 and " +
                                           std::to_string(static_cast<int>(bound.max)));
  }
  return {};
}

ImpairmentDice::ImpairmentDice(const ImpairmentSettings& settings, std::uint64_t direction) noexcept
    : settings_(settings), state_(settings.seed * 2 + direction) {}

// SplitMix64 (Steele, Lea, Flood 2014), its constants; the upper 53 bits make the fraction.
double ImpairmentDice::uniform() noexcept {
  state_ += 0x9E3779B97F4A7C15U;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
  z ^= z >> 31U;
  return static_cast<double>(z >> 11U) * 0x1.0p-53;
}

ImpairmentDice::Fate ImpairmentDice::draw() noexcept {
  Fate fate;
  const double round_trip_s = settings_.delay_s + (2 * uniform() - 1) * settings_.jitter_s;
  fate.delay = from_seconds(std::max(0.0, round_trip_s) / 2);
  fate.is_lost = uniform() < settings_.loss;
  fate.is_duplicated = uniform() < settings_.duplicate;
  fate.is_held_back = uniform() < settings_.reorder;
  return fate;
}

}  // namespace thimble::link
