#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace thimble::cli {

// How the service manager has thimbled.service, in its own words (systemd.unit(5)).
struct ServiceState {
  std::string active;  // ActiveState: "active", "activating", "inactive", "failed"
  std::string result;  // Result of its last end: "success", "exit-code", "watchdog"
  int exit_status{0};  // of its last process, if it came to its end by itself
  bool operator==(const ServiceState&) const = default;
};

// Of an answer of `systemctl show`, beyond which nothing is read.
inline constexpr std::size_t kMaxServiceText = 4096;

// What `systemctl show` prints; nothing where no such service is installed, or of any other text.
// Total. Thread: any. Pure.
[[nodiscard]] std::optional<ServiceState> parse_service_state(std::string_view text);

// Asks `systemctl` of $PATH; nothing where there is none, no manager runs, no such service is
// installed or the answer takes longer than 2 s. Thread: any. Not RT: waits.
[[nodiscard]] std::optional<ServiceState> read_service_state();

// What to do where no daemon answers: goes behind "no daemon is running at PATH; ".
[[nodiscard]] std::string advice_without_daemon(const std::optional<ServiceState>& service);

}  // namespace thimble::cli
