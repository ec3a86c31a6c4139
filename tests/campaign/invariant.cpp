#include "tests/campaign/invariant.hpp"

#include <array>
#include <cstdio>

namespace thimble::campaign {

std::string to_text(const Breach& breach) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), "%s: %.9g instead of at most %.9g, at %.4f s, tick %llu",
                breach.rule.c_str(), breach.value, breach.bound, seconds(breach.at.since_epoch),
                static_cast<unsigned long long>(breach.tick));
  return text.data();
}

std::vector<std::unique_ptr<Invariant>> make_invariants(const Bounds& bounds) {
  std::vector<std::unique_ptr<Invariant>> all;
  all.push_back(make_sent_force(bounds));
  if (bounds.is_tapped) {
    all.push_back(make_arm_force(bounds));
    all.push_back(make_zero_after_stop(bounds));
    all.push_back(make_arm_truth(bounds));
  } else {
    all.push_back(make_untapped_arm(bounds));
  }
  all.push_back(make_let_go(bounds));
  all.push_back(make_latch(bounds));
  all.push_back(make_recovery(bounds));
  all.push_back(make_energy(bounds));
  all.push_back(make_progress(bounds));
  all.push_back(make_bystander(bounds));
  return all;
}

}  // namespace thimble::campaign
