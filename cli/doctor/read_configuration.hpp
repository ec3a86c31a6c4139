#pragma once

#include <string>

#include "cli/doctor/facts.hpp"
#include "cli/doctor/file_tree.hpp"
#include "daemon/config/config.hpp"
#include "daemon/session/plugins.hpp"

namespace thimble::doctor {

// That of the service, systemd/thimbled.service.
inline constexpr const char* kServiceConfiguration = "/etc/thimble/thimble.toml";

struct ReadConfiguration {
  ConfigurationFile about;
  config::Config config;  // the defaults where there is no file, or a bad one
};

// Judges `file` as `thimbled --check` would, loading its plugins into `plugins`; empty: that of the
// service below the root of `tree`, if it is there. Opens no device. Thread: any. Not RT.
[[nodiscard]] ReadConfiguration read_configuration(const FileTree& tree, const std::string& root,
                                                   const std::string& file,
                                                   session::Plugins& plugins);

}  // namespace thimble::doctor
