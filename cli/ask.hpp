#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "cli/client.hpp"
#include "daemon/api/status.hpp"
#include "hal/base/result.hpp"

namespace thimble::cli {

// What every subcommand asks the daemon. Thread: one. Not RT.

// As Client::connect(), and where no daemon is, says what to do.
[[nodiscard]] Result<std::unique_ptr<Client>> connect_to_daemon(const std::string& socket_path);
// Says it on standard error; the exit code that goes with it.
int complain(const Error& error);
// The body of a good answer; of a bad one its sentence.
[[nodiscard]] Result<std::string> ask(Client& client, const std::string& method,
                                      const std::string& target, const std::string& body = {},
                                      std::chrono::seconds timeout = kTimeout);
[[nodiscard]] Result<api::Status> ask_status(Client& client);
// The name of the only arm there is. Errors: InvalidArgument, naming those there are.
[[nodiscard]] Result<std::string> only_arm(Client& client);
// The world of that name; without one, the only one. Errors: InvalidArgument, naming those there
// are.
[[nodiscard]] Result<api::WorldStatus> find_world(const api::Status& status,
                                                  const std::string& name);
// The arm in whose name its world, which may be another host's, is asked for `verb` ("free" or
// "reset"): that of the name, where no world has it, or the only one, where there is no world.
// Nothing: a world here is meant.
[[nodiscard]] std::optional<std::string> arm_that_asks(const api::Status& status,
                                                       std::string_view verb,
                                                       std::string_view name);
[[nodiscard]] Result<api::WorldStatus> ask_for_world(Client& client, const std::string& name);

}  // namespace thimble::cli
