#include "cli/flight/show.hpp"

#include <iostream>

#include "cli/commands.hpp"
#include "cli/file_text.hpp"
#include "cli/flight/recording.hpp"
#include "cli/flight/report.hpp"
#include "cli/terminal.hpp"

namespace thimble::flight {
int run_show(const std::string& file, double before_s) {
  // One byte more than is allowed, so that the parser can say so.
  const auto recording =
      cli::read_at_most(file, kMaxFileBytes + 1).and_then([](const std::string& text) {
        return parse_recording(text);
      });
  if (!recording) {
    std::cerr << "thimble: " << cli::plain(file) << ": " << recording.error().message
              << "; thimbled writes recordings to daemon.flight_directory\n";
    return cli::kExitRefused;
  }
  std::cout << render(*recording, before_s, cli::glyphs_of_environment());
  return cli::kExitOk;
}

}  // namespace thimble::flight
