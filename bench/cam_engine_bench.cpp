// A CAM's step on one core, and on two: by a table without structure beside looking up as many
// entries and beside plain code, the overlap test of a moving piece, and Life.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "bench/comparison.hpp"
#include "bench/reference_cam_step.hpp"
#include "hal/linux/monotonic_clock.hpp"
#include "sim/model/cam/engine/plane_engine.hpp"

namespace {

using namespace thimble;
using bench::Goal;
using sim::cam::Counting;
using sim::cam::PlaneCounts;
using sim::cam::PlaneEngine;
using sim::cam::PlaneKick;
using sim::cam::SiteSpace;
using sim::cam::TablePath;
using Sites = std::vector<std::uint16_t>;

constexpr std::size_t kSites = 262144;

// Microseconds of one call, the least of so many: in the others is also what other processes took
// of the processor and its caches.
template <class Work>
double time_us(std::size_t calls, const Work& work) {
  const linux::MonotonicClock clock;
  double least_us = 1e12;
  for (std::size_t i = 0; i < calls; ++i) {
    const MonotonicTime start = clock.now();
    work();
    least_us = std::min(least_us, seconds(clock.now() - start) * 1e6);
  }
  return least_us;
}

Sites random_sites(std::mt19937& random) {
  Sites sites(kSites);
  for (auto& site : sites) site = static_cast<std::uint16_t>(random());
  return sites;
}

ReferenceCam random_kicks(const SiteSpace& space, std::mt19937& random) {
  const auto& log2 = space.log2_cells;
  ReferenceCam cam{static_cast<unsigned>(log2[0]),
                   static_cast<unsigned>(log2[1]),
                   static_cast<unsigned>(log2[2]),
                   {}};
  for (auto& kick : cam.kicks) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int length = 1 << log2[axis];
      kick[axis] = static_cast<int>(random() % static_cast<unsigned>(length)) - length / 2;
    }
  }
  return cam;
}

std::vector<PlaneKick> planes_of(const ReferenceCam& cam) {
  std::vector<PlaneKick> kicks;
  for (std::size_t layer = 0; layer < 16; ++layer) {
    const int* const kick = cam.kicks[layer];
    kicks.push_back({static_cast<sim::cam::LayerBits>(1U << layer), {kick[0], kick[1], kick[2]}});
  }
  return kicks;
}

// The same on two threads beside one.
bool measure_two_threads(const std::string& name, PlaneEngine& one, PlaneEngine& two,
                         std::span<const PlaneKick> kicks) {
  constexpr sim::cam::StepOptions kOptions{.counting = Counting::Outputs};
  if (one.step(kicks, kOptions) != two.step(kicks, kOptions)) return false;
  bench::Slices ours, alone;
  const auto step_of = [&](PlaneEngine& engine, bench::Slices& slices) {
    return [&] { slices.push_back(time_us(50, [&] { (void)engine.step(kicks, kOptions); })); };
  };
  bench::alternate(bench::kSlices, step_of(two, ours), step_of(one, alone));
  bench::print(bench::compare(name + ", two threads", "us", {Goal::Of::Value, 105}, ours, alone));
  return true;
}

// The general path: 16 kicks, a table that is a permutation, 16 counters.
bool measure_table(const std::string& name, const SiteSpace& space) {
  std::mt19937 random(91);
  Sites table(65536 + 1);
  std::iota(table.begin(), table.end() - 1, std::uint16_t{0});
  std::shuffle(table.begin(), table.end() - 1, random);
  const std::span<const std::uint16_t> entries(table.data(), 65536);
  const ReferenceCam cam = random_kicks(space, random);
  const std::vector<PlaneKick> kicks = planes_of(cam);
  const Sites start = random_sites(random);
  Sites sites = start;
  Sites out(kSites);
  const auto engine = PlaneEngine::make(space, TablePath::General).value();
  if (!engine->load(0, entries) || !engine->put(sites)) return false;
  // They do the same.
  std::array<std::uint64_t, 16> counts{};
  reference_cam_step(cam, table.data(), sites.data(), out.data(), counts.data());
  const auto counted = engine->step(kicks, {.counting = Counting::Outputs});
  if (!counted || *counted != counts || !engine->get(sites) || sites != out) return false;

  bench::Slices ours, limit, plain;
  const auto step = [&] {
    ours.push_back(time_us(50, [&] {
      if (!engine->step(kicks, {.counting = Counting::Outputs})) std::abort();
    }));
  };
  bench::alternate(bench::kSlices, step, [&] {
    const double loop = time_us(
        50, [&] { reference_table_lookup(table.data(), start.data(), out.data(), kSites); });
    const bool has_gather = reference_table_gather(table.data(), start.data(), out.data(), kSites);
    const double gather = time_us(
        50, [&] { reference_table_gather(table.data(), start.data(), out.data(), kSites); });
    limit.push_back(has_gather ? std::min(loop, gather) : loop);
  });
  bench::print(
      bench::compare(name + ", beside look-ups", "us", {Goal::Of::Ratio, 1 / 0.6}, ours, limit));
  bench::print(bench::compare(name, "us", {Goal::Of::Value, 105}, ours, {}));
  ours.clear();
  bench::alternate(bench::kSlices, step, [&] {
    plain.push_back(time_us(1, [&] {
      reference_cam_step(cam, table.data(), start.data(), out.data(), counts.data());
    }));
  });
  bench::print(
      bench::compare(name + ", beside plain code", "us", {Goal::Of::Ratio, 0.1}, ours, plain));
  const auto two =
      PlaneEngine::make(space, TablePath::General, *sim::cam::usable_kernels().front(), 2).value();
  if (!two->load(0, entries) || !engine->get(sites) || !two->put(sites)) return false;
  return measure_two_threads(name, *engine, *two, kicks);
}

// A shape of layer 0 is moved by a cell and meets parts, which have numbers in layers 4 to 9: how
// many sites overlap.
bool measure_overlap() {
  std::mt19937 random(92);
  const Sites sites = random_sites(random);
  Sites table(65536);
  for (std::uint32_t site = 0; site < table.size(); ++site) {
    const bool overlaps = (site & 1) != 0 && (site & 0x3f0) != 0;
    table[site] = static_cast<std::uint16_t>((site & ~8U) | (overlaps ? 8U : 0U));
  }
  const auto engine = PlaneEngine::make({{9, 9, 0}}, TablePath::Auto).value();
  if (!engine->load(0, table) || !engine->put(sites)) return false;
  // Layers 0 and 4 to 9 as planes, for the reference.
  std::array<std::vector<std::uint64_t>, 7> planes;
  std::array<const std::uint64_t*, 6> parts{};
  for (std::size_t plane = 0; plane < planes.size(); ++plane) {
    planes[plane].resize(kSites / 64);
    const std::size_t layer = plane == 0 ? 0 : 3 + plane;
    for (std::size_t i = 0; i < kSites; ++i) {
      planes[plane][i / 64] |= std::uint64_t{sites[i] >> layer & 1U} << i % 64;
    }
    if (plane > 0) parts[plane - 1] = planes[plane].data();
  }
  const auto expected = [&] {
    return reference_overlap(planes[0].data(), parts.data(), parts.size(), kSites / 64);
  };
  const sim::cam::StepOptions only_counts{.written = 0, .counting = Counting::Outputs};
  int by = 1;
  PlaneCounts counts{};
  const auto test = [&] {
    const PlaneKick kick{1, {by, 0, 0}};
    counts = engine->step({&kick, 1}, only_counts).value();
    by = -by;
  };
  test();
  if (counts[3] != expected()) return false;
  bench::Slices ours, plain;
  std::uint64_t sum = 0;
  bench::alternate(
      bench::kSlices, [&] { ours.push_back(time_us(200, test)); },
      [&] { plain.push_back(time_us(200, [&] { sum += expected(); })); });
  if (sum == 0) return false;
  bench::print(
      bench::compare("overlap test, 262144 sites", "us", {Goal::Of::Value, 5}, ours, plain));
  return true;
}

bool measure_life() {
  std::mt19937 random(93);
  Sites sites(kSites);
  for (auto& site : sites) site = random() % 10 < 3 ? 0x1ff : 0;
  Sites table(65536);
  for (std::uint32_t site = 0; site < table.size(); ++site) {
    const int neighbors = std::popcount(site & 0x1feU);
    table[site] = neighbors == 3 || (neighbors == 2 && (site & 1) != 0) ? 0x1ff : 0;
  }
  const std::vector<PlaneKick> kicks{{0x02, {-1, -1, 0}}, {0x04, {0, -1, 0}}, {0x08, {1, -1, 0}},
                                     {0x10, {-1, 0, 0}},  {0x20, {1, 0, 0}},  {0x40, {-1, 1, 0}},
                                     {0x80, {0, 1, 0}},   {0x100, {1, 1, 0}}};
  const auto compiled = PlaneEngine::make({{9, 9, 0}}, TablePath::Compiled).value();
  const auto general = PlaneEngine::make({{9, 9, 0}}, TablePath::General).value();
  for (auto* engine : {compiled.get(), general.get()}) {
    if (!engine->load(0, table) || !engine->put(sites)) return false;
  }
  bench::Slices ours, reference;
  bench::alternate(
      bench::kSlices,
      [&] { ours.push_back(time_us(100, [&] { (void)compiled->step(kicks, {}); })); },
      [&] { reference.push_back(time_us(100, [&] { (void)general->step(kicks, {}); })); });
  if (compiled->population() != general->population()) return false;
  bench::print(bench::compare("Life compiled, beside its table", "us", {Goal::Of::Ratio, 0.5}, ours,
                              reference));
  return true;
}

}  // namespace

int main() {
  if (measure_table("CAM step, 512^2", {{9, 9, 0}}) &&
      measure_table("CAM step, 64^3", {{6, 6, 6}}) && measure_overlap() && measure_life()) {
    return 0;
  }
  std::fputs("bench_cam_engine: the engine did not do what the reference did\n", stderr);
  return 1;
}
