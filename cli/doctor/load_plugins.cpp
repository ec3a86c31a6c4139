#include "cli/doctor/load_plugins.hpp"

#include <iostream>
#include <utility>

#include "cli/text.hpp"
#include "hal/plugin/plugin_file.hpp"

namespace thimble::doctor {

bool load_plugins(session::Plugins& plugins, const std::vector<std::string>& paths) {
  std::vector<std::string> absolute;
  absolute.reserve(paths.size());
  for (const std::string& path : paths) {
    Result<std::string> whole = plugin::absolute_plugin_path(path);
    if (!whole) {
      std::cerr << "thimble: " << cli::plain(whole.error().message) << '\n';
      return false;
    }
    absolute.push_back(*std::move(whole));
  }
  const std::vector<Error> refused = plugins.load(absolute);
  for (const Error& error : refused) std::cerr << "thimble: " << cli::plain(error.message) << '\n';
  return refused.empty();
}

}  // namespace thimble::doctor
