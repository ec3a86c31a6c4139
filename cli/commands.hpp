#pragma once

#include <optional>
#include <string>

#include "cli/world_edit.hpp"
#include "daemon/api/status.hpp"
#include "hal/base/result.hpp"

namespace thimble::cli {

// What a shell sees.
inline constexpr int kExitOk = 0;
inline constexpr int kExitRefused = 1;  // the daemon, or a file, says no
inline constexpr int kExitUsage = 2;
inline constexpr int kExitNoDaemon = 3;

struct WatchOptions {
  double interval_s{0.1};
  std::optional<double> for_s;
};

// The state of the daemon at that socket. Errors: as Client's, and what the daemon says.
[[nodiscard]] Result<api::Status> daemon_status(const std::string& socket_path);

// Each does one subcommand: writes to standard output, mistakes to standard error, and returns
// the exit code.
int run_status(const std::string& socket_path, bool is_json);
int run_watch(const std::string& socket_path, const WatchOptions& options);
// `verb` is "activate", "deactivate", "clear-fault", "impedance", "free" or "reset"; an empty arm
// means the only one. `body` is what the request says besides (docs/api.md).
int run_command(const std::string& socket_path, const std::string& verb, const std::string& arm,
                const std::string& body = {});
// An empty world means the only one.
int run_world_edit(const std::string& socket_path, const std::string& world, const WorldEdit& edit);
// Saves the state of a world that runs by itself to a file, or puts one back (`edit.verb`).
int run_world_state(const std::string& socket_path, const std::string& world,
                    const WorldEdit& edit);
// `verb` is "select", "drop", "delete", "free" or "reset", done to the pieces of the world; refused
// also where the world says that it could not be. An empty name means the only world; "free" and
// "reset" may name an arm instead, whose world is asked wherever it is (arm_that_asks()).
int run_piece_action(const std::string& socket_path, const std::string& verb,
                     const std::string& name);
// Prints what a file of `thimbled --summary` says of a session.
int run_report(const std::string& file);

}  // namespace thimble::cli
