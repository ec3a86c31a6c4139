// What a second of virtual time costs: one simulated arm in the thesis's box, its bus, driver,
// servo, limiter, coupling, link and world, on one core, as `thimble lab run` plays it. Counted is
// the processor's time: what others do on that core meanwhile is not ours.
#include <cstdio>
#include <ctime>

#include "bench/comparison.hpp"
#include "lab/run/run.hpp"

namespace {

using namespace thimble;

constexpr double kVirtual_s = 10;  // of a slice
constexpr double kMost_ms = 10;    // for each of them: 100 times as fast as real time

double processor_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace

int main() {
  bench::Slices each_ms;
  for (std::size_t slice = 0; slice < bench::kSlices; ++slice) {
    const auto run = lab::SessionRun::load({.files = {THIMBLE_SOURCE_DIR "/tests/data/hello.toml"},
                                            .overrides = {},
                                            .seed = {},
                                            .for_s = kVirtual_s});
    if (!run) {
      std::fprintf(stderr, "virtual_time: %s\n", run.error().message.c_str());
      return 1;
    }
    const double begin_ms = processor_ms();
    (*run)->play();
    const double end_ms = processor_ms();
    if ((*run)->session().arm(0).session().snapshot().total_contacts == 0) {
      std::fprintf(stderr, "virtual_time: the hand touched nothing\n");
      return 1;
    }
    each_ms.push_back((end_ms - begin_ms) / kVirtual_s);
  }
  bench::print(bench::compare("virtual second of one arm", "ms", {bench::Goal::Of::Value, kMost_ms},
                              each_ms, {}));
  return 0;
}
