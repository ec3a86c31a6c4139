#pragma once

#include <memory>

#include "daemon/devices/arm_guard.hpp"

namespace thimble::test {

// Guards that watch whatever they are given, for arms on a bus that is no simulated one as far as a
// session can tell. What real ones do: unit_guard, process.guard.
class WillingGuard final : public devices::ArmGuard {
 public:
  [[nodiscard]] rt::Heartbeat& heartbeat() noexcept override { return heartbeat_; }
  Result<void> ask(const bus::DeviceAddress& /*address*/, const ZeroCommand& /*zero*/) override {
    return {};
  }
  [[nodiscard]] Result<bool> is_watching() override { return true; }

 private:
  rt::Heartbeat heartbeat_;
};

class WillingGuards final : public devices::ArmGuards {
 public:
  [[nodiscard]] Result<std::unique_ptr<devices::ArmGuard>> make() override {
    return std::make_unique<WillingGuard>();
  }
};

}  // namespace thimble::test
