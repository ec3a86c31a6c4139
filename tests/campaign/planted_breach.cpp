#include "tests/campaign/planted_breach.hpp"

#include <memory>
#include <vector>

namespace thimble::campaign {
namespace {

constexpr double kLongestPress_s = 0.03;

class NoEstop final : public Invariant {
 public:
  void see(const Observation& now, Findings& findings) override {
    if (now.is_estop_healthy) since_ = now.servo.frame.now;
    findings.at_most("e-stop pressed, s", seconds(now.servo.frame.now - since_), kLongestPress_s);
  }

 private:
  MonotonicTime since_{};
};

}  // namespace

Planted planted_breach() {
  Planted planted;
  planted.invariants = [](const Bounds&) {
    std::vector<std::unique_ptr<Invariant>> all;
    all.push_back(std::make_unique<NoEstop>());
    return all;
  };
  return planted;
}

}  // namespace thimble::campaign
