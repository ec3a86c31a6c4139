#pragma once

#include <sys/types.h>

#include <optional>
#include <string>

namespace thimble::bench {

// A thimbled of this build with the configuration of `examples/hello-voxel.toml`, in a temporary
// folder of its own, its words thrown away.
//
// Thread: one. Ownership: the destructor stops it and removes the folder.
class DaemonProcess {
 public:
  // Nothing when the program cannot be started. To be called from the top of the source tree.
  DaemonProcess();
  ~DaemonProcess();
  DaemonProcess(const DaemonProcess&) = delete;
  DaemonProcess& operator=(const DaemonProcess&) = delete;

  [[nodiscard]] bool is_started() const noexcept { return child_ > 0; }
  [[nodiscard]] std::string id() const { return std::to_string(child_); }
  // Asks the status until the servo has ticked, every half millisecond; false after 5 s.
  [[nodiscard]] bool wait_for_first_tick() const;

 private:
  [[nodiscard]] bool has_ticked() const;

  std::string folder_;
  std::string socket_;
  pid_t child_{0};
};

}  // namespace thimble::bench
