#include "daemon/app/inspect_places.hpp"

#include <filesystem>
#include <string>
#include <system_error>

#include "daemon/api/socket_file.hpp"
#include "daemon/app/recording_folder.hpp"
#include "daemon/config/paths.hpp"

namespace thimble::app {
namespace {

void object(std::vector<config::Objection>& out, const std::string& key,
            const Result<void>& checked) {
  if (checked) return;
  out.push_back({config::Objection::Table::Daemon, 0, key, checked.error().message});
}

// Ours where nobody said another one, and there made (api::SocketFile): systemd's RuntimeDirectory=
// is not there while the service is not.
bool is_default_folder(const std::filesystem::path& folder) {
  const auto own = config::default_socket_path(config::process_environment());
  return folder == std::filesystem::path(own).parent_path() || folder == config::kServiceFolder;
}

// A folder that nobody made is a slip of the pen. One that cannot be looked at is the start's.
Result<void> check_socket_folder(const std::string& socket) {
  const std::filesystem::path folder = std::filesystem::path(socket).parent_path();
  std::error_code error;
  const auto found = std::filesystem::status(folder, error);
  if (folder.empty() || is_default_folder(folder)) return {};
  if (found.type() == std::filesystem::file_type::not_found) {
    return fail(Errc::NotFound, "there is no folder " + folder.string() +
                                    " for the socket; correct daemon.socket, or make the folder: "
                                    "only the default ones are made");
  }
  if (error || std::filesystem::is_directory(found)) return {};
  return fail(Errc::InvalidArgument, folder.string() + " is no folder for the socket");
}

Result<void> check_socket(const std::string& socket) {
  const Result<void> checked = api::check_socket_path(socket);
  return checked ? check_socket_folder(socket) : checked;
}

}  // namespace

// Of what the configuration names: what is chosen where it names none depends on who starts it.
std::vector<config::Objection> inspect_socket(const config::Config& config) {
  const config::DaemonConfig& daemon = config.daemon;
  std::vector<config::Objection> out;
  if (daemon.socket) object(out, "socket", check_socket(*daemon.socket));
  if (daemon.group) object(out, "group", api::check_socket_group(*daemon.group));
  return out;
}

std::vector<config::Objection> inspect_recordings(const config::Config& config) {
  std::vector<config::Objection> out;
  const auto& directory = config.daemon.flight_directory;
  if (directory) object(out, "flight_directory", check_recording_folder(*directory));
  return out;
}

}  // namespace thimble::app
