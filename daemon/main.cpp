#include "daemon/app/application.hpp"
#include "daemon/app/options.hpp"
#include "hal/linux/standard_streams.hpp"

int main(int argc, char** argv) {
  thimble::linux::occupy_closed_standard_descriptors();
  const tl::expected<thimble::app::Options, int> options = thimble::app::parse_options(argc, argv);
  return thimble::app::finish(options ? thimble::app::run(*options) : options.error());
}
