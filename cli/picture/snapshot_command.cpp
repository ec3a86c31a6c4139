#include <memory>

#include "cli/picture/snapshot.hpp"

namespace thimble::picture {

void add_snapshot_command(CLI::App& app, const std::string& socket_path, int& code) {
  struct Said {
    std::string world;
    std::string file;
  };
  const auto said = std::make_shared<Said>();
  CLI::App* command =
      app.add_subcommand("snapshot", "Draw a world of cells, and the fingers in it");
  command->add_option("WORLD", said->world, "Name of the world; not needed when there is one");
  command->add_option("--file", said->file, "The picture, PNG")->required();
  command->callback(
      [&socket_path, &code, said] { code = run_snapshot(socket_path, said->world, said->file); });
}

}  // namespace thimble::picture
