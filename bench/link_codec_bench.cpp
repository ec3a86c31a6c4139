// What it costs to write one datagram of our own and read it again, in the clear and sealed: a
// hand's sample, constraints of three planes with a ghost, and the same with as many blocks of a
// map as one answer tells. Beside the first the same bytes
// copied there and back, beside the second libsodium's seal alone.
#include <cstdio>
#include <string>

#include "bench/comparison.hpp"
#include "bench/processor_time.hpp"
#include "bench/reference_datagram.hpp"
#include "daemon/link/seal.hpp"
#include "daemon/world/occupancy_teller.hpp"
#include "daemon/world/voxel_grid.hpp"

namespace {

using namespace thimble;

constexpr int kTimes = 20000;

template <class Run>
double nanoseconds_each(const Run& run) {
  const double begin_s = bench::processor_s();
  run();
  return 1e9 * (bench::processor_s() - begin_s) / kTimes;
}

link::Seal seal(bool is_sealed) {
  if (!is_sealed) return {};
  std::array<std::byte, link::LinkKey::kSize> key{};
  return link::Seal::of_session(link::LinkKey(key), link::Towards::World, {}, {}, 1);
}

// One way of a datagram: packed, its header read, opened, its content read. False: it failed.
template <class Message>
bool carry(const link::Seal& seal, link::ThimbleKind kind, std::uint64_t sequence,
           const Message& message, Message& out, std::size_t& size) {
  link::ThimbleDatagram datagram;
  const auto packed = seal.pack({.kind = kind, .session = 1, .sequence = sequence}, message,
                                link::RandomBytes(), datagram);
  size = datagram.size;
  std::array<std::byte, link::kMaxThimbleContent> room;
  const auto header = link::decode_header(datagram.view());
  if (!packed || !header) return false;
  const auto content = seal.open(*header, datagram.view(), room);
  return content && decode(*content, out);
}

template <class Message>
bool compare(const std::string& name, link::ThimbleKind kind, const Message& message,
             bool is_sealed) {
  const link::Seal with = seal(is_sealed);
  Message out;
  std::size_t size = 0;
  bool is_good = carry(with, kind, 1, message, out, size);
  bench::Slices ours;
  bench::Slices reference;
  bench::alternate(
      bench::kSlices,
      [&] {
        ours.push_back(nanoseconds_each([&] {
          for (int i = 0; i < kTimes; ++i) {
            is_good =
                carry(with, kind, static_cast<std::uint64_t>(i) + 1, message, out, size) && is_good;
          }
        }));
      },
      [&] {
        reference.push_back(nanoseconds_each([&] {
          is_good = is_good && (is_sealed ? reference_seals(size, kTimes) == kTimes
                                          : reference_copies(size, kTimes) > 0);
        }));
      });
  if (!is_good) {
    std::fputs("bench_link_codec: a datagram does not come back\n", stderr);
    return false;
  }
  bench::print(bench::compare(name, "ns", {bench::Goal::Of::Value, is_sealed ? 2000.0 : 300.0},
                              ours, reference));
  return true;
}

}  // namespace

int main() {
  link::ThimbleSample sample;
  sample.sample.sequence = 1;
  sample.sample.hand = {0.0155, 0.01, -0.02};
  sample.sample.velocity = {0.2, 0, 0.1};
  link::ThimbleConstraints planes;
  planes.request = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    coupling::ConstraintPlane plane{.offset_m = 0.015, .surface = {{800}, {5}, 0.2}};
    plane.normal[axis] = 1;
    planes.set.planes.push_back(plane);
  }
  planes.set.has_ghost = true;
  planes.set.ghost = {0.015, 0.01, -0.02};
  link::ThimbleConstraints map = planes;
  map.set.has_map = true;
  const world::VoxelGrid box = *world::make_box(64);
  world::OccupancyTeller teller;
  teller.reset();
  map.set.map = {.lattice = box.lattice(),
                 .ghost_cell = {32, 32, 32},
                 .blocks = teller.tell(box, {32, 32, 32}, 1)};
  for (const bool is_sealed : {false, true}) {
    const std::string how = is_sealed ? ", sealed" : ", in the clear";
    const auto constraints = link::ThimbleKind::Constraints;
    if (!compare("datagram, sample" + how, link::ThimbleKind::Sample, sample, is_sealed) ||
        !compare("datagram, three planes" + how, constraints, planes, is_sealed) ||
        !compare("datagram, four blocks" + how, constraints, map, is_sealed)) {
      return 1;
    }
  }
  return 0;
}
