#include "cli/doctor/read_configuration.hpp"

#include <unistd.h>

#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "cli/doctor/accounts.hpp"
#include "cli/doctor/rights.hpp"
#include "daemon/config/load.hpp"
#include "daemon/session/inspect.hpp"

namespace thimble::doctor {
namespace {

// Nobody is kept out whose account is not known.
bool may_service_read(const Accounts& accounts, const Node& node) {
  const auto groups = accounts.groups_of("thimble");
  if (!groups || groups->empty()) return true;
  Process service;
  service.groups = *groups;
  for (const char* name : {"thimble", "thimble-users"}) {  // of the unit, not of a login
    const auto number = accounts.group(name);
    if (number && *number) service.groups.push_back(**number);
  }
  const auto owner = accounts.user_name(node.user);
  const bool is_its_own = owner && *owner == "thimble";
  service.user = is_its_own ? node.user : std::numeric_limits<std::uint32_t>::max();
  return may(service, node, kRead);
}

}  // namespace

ReadConfiguration read_configuration(const FileTree& tree, const std::string& root,
                                     const std::string& file, session::Plugins& plugins) {
  ReadConfiguration read;
  const Node node = tree.node(kServiceConfiguration);
  if (file.empty() && !node.is_there) return read;
  read.about.file = file.empty() ? tree.place_of(kServiceConfiguration) : file;
  if (file.empty()) read.about.may_service_read = may_service_read(*accounts_below(root), node);
  if (file.empty() && ::access(read.about.file.c_str(), R_OK) != 0) {
    read.about.is_hidden = true;
    return read;
  }
  config::ConfigResult loaded =
      config::load(read.about.file, {}, [&](const config::Config& config) {
        std::vector<config::Objection> all = session::inspect_with_plugins(config, plugins);
        const auto of_files = session::inspect_files(config, plugins.drivers);
        all.insert(all.end(), of_files.begin(), of_files.end());
        return all;
      });
  if (loaded) {
    read.config = *std::move(loaded);
    read.about.doubts = session::doubts_of(read.config, plugins.drivers);
    return read;
  }
  for (const config::ConfigError& error : loaded.error()) {
    read.about.mistakes.push_back(config::to_string(error));
  }
  return read;
}

}  // namespace thimble::doctor
