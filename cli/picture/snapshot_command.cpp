#include <memory>

#include "cli/names.hpp"
#include "cli/picture/snapshot.hpp"

namespace thimble::picture {

std::string refuse_other_than_png(const std::string& name) {
  const bool is_good = name.ends_with(".png") || name.starts_with("/dev/");
  return is_good ? "" : "a picture is written to a file ending in .png";
}

void add_snapshot_command(CLI::App& app, const std::string& socket_path, int& code) {
  struct Said {
    std::string world;
    std::string file;
  };
  const auto said = std::make_shared<Said>();
  CLI::App* command =
      app.add_subcommand("snapshot",
                         "Draw a world of cells (a box, a volume, pieces, one that runs by "
                         "itself), and the fingers in it");
  command->add_option("WORLD", said->world, "Name of the world; not needed when there is one")
      ->check(cli::refuse_no_name);
  command->add_option("--file", said->file, "The picture: .png")
      ->required()
      ->check(refuse_other_than_png);
  command->callback(
      [&socket_path, &code, said] { code = run_snapshot(socket_path, said->world, said->file); });
}

}  // namespace thimble::picture
