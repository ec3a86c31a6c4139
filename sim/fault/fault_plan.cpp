#include "sim/fault/fault_plan.hpp"

namespace thimble::sim {
namespace {

constexpr std::uint64_t mix(std::uint64_t x) noexcept {
  x += 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31U);
}

}  // namespace

bool ScriptedFault::covers(MonotonicTime t) const noexcept {
  if (t < from) return false;
  // The defaults reach to the ends of the time line, where a difference would overflow.
  if (lasts == Duration::max() || from.since_epoch == Duration::min()) return true;
  return t - from < lasts;
}

bool ScriptedFault::covers(std::uint64_t report) const noexcept {
  return report >= first_report && report - first_report < reports;
}

std::uint64_t fault_bits(std::uint64_t seed, FaultKind kind, std::uint64_t report) noexcept {
  return mix(mix(mix(seed) ^ static_cast<std::uint64_t>(kind)) ^ report);
}

bool fault_strikes(std::uint64_t bits, double chance) noexcept {
  constexpr double kTwoTo53 = 9007199254740992.0;  // all values of the top 53 bits
  return static_cast<double>(bits >> 11U) < chance * kTwoTo53;
}

}  // namespace thimble::sim
