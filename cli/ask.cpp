#include "cli/ask.hpp"

#include <algorithm>
#include <iostream>

#include "cli/commands.hpp"
#include "cli/service_state.hpp"
#include "cli/status_document.hpp"
#include "cli/text.hpp"

namespace thimble::cli {

Result<std::unique_ptr<Client>> connect_to_daemon(const std::string& socket_path) {
  auto client = Client::connect(socket_path);
  if (client || client.error().code != Errc::NotFound) return client;
  return fail(Errc::NotFound,
              client.error().message + "; " + advice_without_daemon(read_service_state()));
}

int complain(const Error& error) {
  std::cerr << "thimble: " << error.message << '\n';
  const bool is_gone = error.code == Errc::NotFound || error.code == Errc::Disconnected;
  return is_gone ? kExitNoDaemon : kExitRefused;
}

Result<std::string> ask(Client& client, const std::string& method, const std::string& target,
                        const std::string& body, std::chrono::seconds timeout) {
  auto reply = client.request(method, target, body, timeout);
  if (!reply) return tl::unexpected<Error>(reply.error());
  if (reply->http_status == 200) return std::move(reply->body);
  return fail(Errc::Busy,
              plain(parse_error_message(reply->body, "the daemon answers with HTTP status " +
                                                         std::to_string(reply->http_status))));
}

Result<api::Status> ask_status(Client& client) {
  auto body = ask(client, "GET", "/v1/status");
  if (!body) return tl::unexpected<Error>(body.error());
  return parse_status(*body);
}

Result<std::string> only_arm(Client& client) {
  auto status = ask_status(client);
  if (!status) return tl::unexpected<Error>(status.error());
  if (status->arms.size() == 1) return status->arms.front().name;
  std::string names;
  for (const auto& arm : status->arms) names += (names.empty() ? "" : ", ") + plain(arm.name);
  return fail(Errc::InvalidArgument,
              names.empty() ? "this daemon has no arm" : "say which arm: " + names);
}

Result<api::WorldStatus> find_world(const api::Status& status, const std::string& name) {
  std::string names;
  for (const api::WorldStatus& world : status.worlds) {
    if (world.name == name || (name.empty() && status.worlds.size() == 1)) return world;
    names += (names.empty() ? "" : ", ") + plain(world.name);
  }
  return fail(Errc::InvalidArgument, names.empty() ? "this daemon has no world"
                                     : name.empty()
                                         ? "say which world: " + names
                                         : "there is no world " + plain(name) + ", but " + names);
}

std::optional<std::string> arm_that_asks(const api::Status& status, std::string_view verb,
                                         std::string_view name) {
  if (verb != "free" && verb != "reset") return std::nullopt;
  const auto is_named = [&](const auto& one) { return one.name == name; };
  if (std::any_of(status.worlds.begin(), status.worlds.end(), is_named)) return std::nullopt;
  if (std::any_of(status.arms.begin(), status.arms.end(), is_named)) return std::string(name);
  const bool is_only = name.empty() && status.worlds.empty() && status.arms.size() == 1;
  return is_only ? std::optional(status.arms.front().name) : std::nullopt;
}

Result<api::WorldStatus> ask_for_world(Client& client, const std::string& name) {
  const auto status = ask_status(client);
  if (!status) return tl::unexpected<Error>(status.error());
  return find_world(*status, name);
}

}  // namespace thimble::cli
