#include <cstdio>
#include <string_view>

#include "board/board_bar.hpp"
#include "hal/linux/passed_descriptors.hpp"

namespace {

using namespace thimble;

// The connection that systemd accepted (StandardInput=socket).
constexpr int kConnection = 0;

Result<void> hand_over(std::string_view slot, std::string_view bar) {
  const auto named = board::parse_bar(slot, bar);
  if (!named) return tl::unexpected(named.error());
  const auto node = board::open_board("/sys/bus/pci/devices", *named);
  if (!node) return tl::unexpected(node.error());
  return linux::send_descriptor(kConnection, *node);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::string_view(argv[1]) == "--version") {
    std::puts("thimble-board " THIMBLE_VERSION);
    return 0;
  }
  if (argc != 3) {
    std::fputs(
        "usage: thimble-board SLOT BAR\nsystemd starts it for thimbled, and takes both words from "
        "BOARD= in /etc/default/thimble-board. See thimble-board(8).\n",
        stderr);
    return 2;
  }
  const auto done = hand_over(argv[1], argv[2]);
  if (!done) std::fprintf(stderr, "thimble-board: %s\n", done.error().message.c_str());
  return done ? 0 : 1;
}
