// A simulated CAM board in the memory of a file, until its standard input ends.
#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <string_view>

#include "hal/linux/descriptor.hpp"
#include "hal/linux/monotonic_clock.hpp"
#include "sim/model/cam/board_page.hpp"

namespace {

using namespace thimble;

// As thimble-simdev's cam-8, but for the window, which is what the page leaves of the BAR.
sim::cam::BoardOptions options_for(std::size_t bar_bytes) {
  return {.shape = {{2, 2, 2}, 16}, .window_bytes = bar_bytes - cambus::page::kPageBytes};
}

// About as long as a guest's page takes to be seen.
constexpr int kRest_us = 50;

bool is_over() {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  return ::poll(&input, 1, 0) > 0;
}

int serve(const char* path) {
  const linux::Descriptor file(::open(path, O_RDWR | O_CLOEXEC));
  struct stat facts {};
  if (file.get() < 0 || ::fstat(file.get(), &facts) != 0) return std::perror(path), 1;
  const auto bytes = static_cast<std::size_t>(facts.st_size);
  if (bytes <= cambus::page::kPageBytes || bytes % cambus::page::kPageBytes != 0) {
    return std::fputs("no size of a BAR\n", stderr), 2;
  }
  void* memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file.get(), 0);
  if (memory == MAP_FAILED) return std::perror(path), 1;
  linux::MonotonicClock clock;
  sim::cam::BoardPage board(
      options_for(bytes),
      bus::SharedWords({static_cast<std::uint32_t*>(memory), bytes / sizeof(std::uint32_t)}),
      clock.now());
  std::puts("in its slot");
  std::fflush(stdout);
  while (!is_over()) {
    board.serve(clock.now());
    ::usleep(kRest_us);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return std::fputs("usage: board_in_slot FILE\n", stderr), 2;
  return serve(argv[1]);
}
