#include "cli/doctor/load_plugins.hpp"

#include <filesystem>
#include <iostream>

#include "cli/text.hpp"

namespace thimble::doctor {

bool load_plugins(session::Plugins& plugins, const std::vector<std::string>& paths) {
  std::vector<std::string> absolute;
  absolute.reserve(paths.size());
  for (const std::string& path : paths) {
    if (path.empty()) {
      std::cerr << "thimble: --plugin: the name of a file is expected, and it is empty\n";
      return false;
    }
    absolute.push_back(std::filesystem::absolute(path).string());
  }
  const std::vector<Error> refused = plugins.load(absolute);
  for (const Error& error : refused) std::cerr << "thimble: " << cli::plain(error.message) << '\n';
  return refused.empty();
}

}  // namespace thimble::doctor
