#include "hal/bus/gpio_lines.hpp"

#include <algorithm>

namespace thimble::bus {

Result<void> check(const GpioClaim& claim) {
  if (claim.chip.empty()) return fail(Errc::InvalidArgument, "no chip is named");
  if (claim.inputs.empty() && claim.outputs.empty()) {
    return fail(Errc::InvalidArgument, claim.chip + ": no line is named");
  }
  if (claim.inputs.size() > kMaxGpioLines || claim.outputs.size() > kMaxGpioLines) {
    return fail(Errc::InvalidArgument, claim.chip + ": more than 8 lines are named");
  }
  std::vector<std::string> all = claim.inputs;
  all.insert(all.end(), claim.outputs.begin(), claim.outputs.end());
  std::sort(all.begin(), all.end());
  const auto twice = std::adjacent_find(all.begin(), all.end());
  if (twice != all.end()) {
    return fail(Errc::InvalidArgument, claim.chip + ": line " + *twice + " is named twice");
  }
  return {};
}

}  // namespace thimble::bus
