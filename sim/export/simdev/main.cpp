#include <sys/stat.h>

#include <csignal>
#include <cstdio>

#include "hal/linux/standard_streams.hpp"
#include "sim/export/simdev/options.hpp"
#include "sim/export/simdev/run.hpp"

int main(int argc, char** argv) {
  thimble::linux::occupy_closed_standard_descriptors();
  std::signal(SIGPIPE, SIG_IGN);
  ::umask(077);  // the verbs' socket is for whoever started this
  const auto options = thimble::sim::parse_simdev_options(argc, argv);
  if (!options) return options.error();
  const thimble::Result<void> done = thimble::sim::run_simdev(*options);
  if (done) return 0;
  std::fprintf(stderr, "thimble-simdev: %s\n", done.error().message.c_str());
  const bool is_mistaken = done.error().code == thimble::Errc::InvalidArgument;
  return is_mistaken ? thimble::sim::kExitUsage : 1;
}
