#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "daemon/devices/arm_guard.hpp"
#include "hal/base/result.hpp"
#include "hal/linux/descriptor.hpp"
#include "hal/linux/shared_device.hpp"

namespace thimble::app {

// Where guards come from.
struct GuardSettings {
  // systemd's thimble-guard.socket: each connection is a guard in a unit of its own.
  std::filesystem::path socket;
  // Started by the daemon itself where there is no such socket, in a session of its own.
  std::filesystem::path program;
  // The open device, for the guard: linux::BusEnumerator::share().
  std::function<Result<linux::SharedDevice>(const bus::DeviceAddress&)> share;
};
// As they are on this machine: /run/thimble-guard.sock, and thimble-guard beside this program.
[[nodiscard]] GuardSettings default_guard_settings();

// Guards that are processes: thimble-guard(8).
//
// Thread: control thread. Not RT; waits for no guard. Errors: System, Permission; each says what to
// do.
class GuardKeeper final : public devices::ArmGuards {
 public:
  explicit GuardKeeper(GuardSettings settings) : settings_(std::move(settings)) {}
  ~GuardKeeper() override;
  GuardKeeper(const GuardKeeper&) = delete;
  GuardKeeper& operator=(const GuardKeeper&) = delete;

  [[nodiscard]] Result<std::unique_ptr<devices::ArmGuard>> make() override;

 private:
  friend class GuardProcess;
  // A socket with a guard at its other end.
  [[nodiscard]] Result<linux::Descriptor> connect();
  [[nodiscard]] Result<linux::Descriptor> start();
  // Guards that this process started, and that ended, leave the list of processes.
  void reap() noexcept;

  GuardSettings settings_;
  std::vector<pid_t> started_;
};

}  // namespace thimble::app
