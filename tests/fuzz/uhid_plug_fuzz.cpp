#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "hal/base/check.hpp"
#include "sim/export/uhid_plug.hpp"
#include "sim/model/arm/register_arm_models.hpp"
#include "sim/model/cp2112/cp2112_model.hpp"
#include "tests/unit/export/export_bench.hpp"

namespace {

using namespace thimble;

std::unique_ptr<plugin::SimHidModel> model_of(std::uint8_t which) {
  if (which % 3 == 2) return std::make_unique<sim::Cp2112Model>();
  plugin::SimModelRegistry models;
  sim::register_arm_models(models);
  const char* name = which % 3 == 1 ? "woody-2015" : "phantom-vintage";
  auto model = models.find(name)->create_hid({.amplifier_max_a = 3});
  THIMBLE_CHECK(model.has_value());
  return *std::move(model);
}

}  // namespace

// Whatever the kernel's side says: no more than the model's own reports come back, and the plug
// works on. The first byte: which model; then pieces, each with its length in two bytes, and a
// frame after each; 0xffff: pulled and plugged in.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  std::array<int, 2> ends{};
  THIMBLE_CHECK(
      ::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()) == 0);
  const auto model = model_of(data[0]);
  sim::ExportBench bench;
  sim::UhidPlug plug(linux::Descriptor(ends[0]), *model, model->describe(), bench.surroundings());
  THIMBLE_CHECK(plug.plug().has_value());
  std::size_t at = 1;
  for (int i = 0; i < 64 && at + 2 <= size; ++i) {
    const std::size_t length = data[at] | static_cast<std::size_t>(data[at + 1]) << 8U;
    at += 2;
    if (length == 0xffff) {
      THIMBLE_CHECK(plug.unplug(sim::Supply::Goes).has_value() && plug.plug().has_value());
      continue;
    }
    const std::size_t piece = std::min(length, size - at);
    if (piece > 0) static_cast<void>(::write(ends[1], data + at, piece));
    at += piece;
    bench.run_frames(1);
    std::array<std::uint8_t, 8192> heard{};
    while (::read(ends[1], heard.data(), heard.size()) > 0) {
    }
  }
  THIMBLE_CHECK(plug.is_plugged() && !plug.is_broken());
  const sim::PlugCounters counters = plug.counters();
  THIMBLE_CHECK(counters.from_host + counters.superseded + counters.requests + counters.malformed +
                    counters.lost <=
                256);
  ::close(ends[1]);
  return 0;
}
