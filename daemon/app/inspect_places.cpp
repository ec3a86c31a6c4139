#include "daemon/app/inspect_places.hpp"

#include <string>

#include "daemon/api/socket_file.hpp"
#include "daemon/app/recording_folder.hpp"

namespace thimble::app {
namespace {

void object(std::vector<config::Objection>& out, const std::string& key,
            const Result<void>& checked) {
  if (checked) return;
  out.push_back({config::Objection::Table::Daemon, 0, key, checked.error().message});
}

}  // namespace

// Of what the configuration names: what is chosen where it names none depends on who starts it.
std::vector<config::Objection> inspect_socket(const config::Config& config) {
  const config::DaemonConfig& daemon = config.daemon;
  std::vector<config::Objection> out;
  if (daemon.socket) object(out, "socket", api::check_socket_path(*daemon.socket));
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
