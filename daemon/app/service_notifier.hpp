#pragma once

#include <sys/socket.h>
#include <sys/un.h>

#include <optional>
#include <string>
#include <string_view>

#include "hal/base/time.hpp"

namespace thimble::app {

// The service manager's ear (the protocol of sd_notify(3)): READY, STATUS, WATCHDOG, STOPPING.
// Does nothing when nobody listens. Never waits: what a listener that does not read has no room
// for is owed, the newest status only, and sent by the next call (decision 0111).
// Thread: one. Not RT.
class ServiceNotifier {
 public:
  // For the listener of this process's environment (NOTIFY_SOCKET), if there is one.
  ServiceNotifier();
  // For the socket of that path, or "@NAME" of the abstract ones; empty: nobody listens.
  explicit ServiceNotifier(std::string_view socket_name);
  ~ServiceNotifier();
  ServiceNotifier(const ServiceNotifier&) = delete;
  ServiceNotifier& operator=(const ServiceNotifier&) = delete;

  void ready(const std::string& status);
  void status(const std::string& status);
  void stopping();
  // Call when the servo threads have been seen alive.
  void alive();
  // Sends what is owed, if anything; call now and then.
  void retry();
  // How often alive() must be called: half of WATCHDOG_USEC; nothing when not asked for.
  [[nodiscard]] std::optional<Duration> watchdog_interval() const noexcept { return interval_; }

 private:
  [[nodiscard]] std::string owed() const;

  int socket_{-1};
  sockaddr_un address_{};
  socklen_t address_bytes_{0};
  std::optional<Duration> interval_;
  std::string owed_states_;  // lines
  std::string owed_status_;
  bool owes_alive_{false};
};

}  // namespace thimble::app
