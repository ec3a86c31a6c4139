// What the largest volume costs to load: 1024^3 numbers of 16 bits, 2 GiB, raw behind a detached
// NRRD header. Every second slice of numbers is above the threshold, so that half the cells are
// filled.
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "bench/comparison.hpp"
#include "bench/process_memory.hpp"
#include "bench/reference_read_file.hpp"
#include "daemon/world/io/nrrd.hpp"

namespace {

using namespace thimble;

constexpr std::size_t kSide = 1024;
constexpr std::size_t kDataBytes = 2 * kSide * kSide * kSide;
// Both sides take seconds: fewer slices than elsewhere.
constexpr std::size_t kFewSlices = 5;

class VolumeFile {
 public:
  VolumeFile() : folder_("/tmp/thimble-bench-" + std::to_string(::getpid())) {
    std::filesystem::create_directory(folder_);
    std::ofstream(header()) << "NRRD0004\ntype: ushort\ndimension: 3\nsizes: 1024 1024 1024\n"
                               "endian: little\nencoding: raw\ndata file: volume.raw\n\n";
    std::ofstream out(data(), std::ios::binary);
    std::vector<char> slice(2 * kSide * kSide);
    for (std::size_t z = 0; z < kSide; ++z) {
      std::fill(slice.begin(), slice.end(), z % 2 == 0 ? '\7' : '\0');
      out.write(slice.data(), static_cast<std::streamsize>(slice.size()));
    }
  }
  VolumeFile(const VolumeFile&) = delete;
  VolumeFile& operator=(const VolumeFile&) = delete;
  ~VolumeFile() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  [[nodiscard]] std::string header() const { return folder_ + "/volume.nhdr"; }
  [[nodiscard]] std::string data() const { return folder_ + "/volume.raw"; }

 private:
  std::string folder_;
};

template <class Work>
double seconds_of(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

[[nodiscard]] bool is_loaded(const std::string& path) {
  const auto grid = world::load_nrrd_file(path, {});
  if (!grid) std::fprintf(stderr, "%s\n", grid.error().message.c_str());
  return grid && grid->is_occupied({5, 6, 8}) && !grid->is_occupied({5, 6, 7});
}

}  // namespace

int main() {
  const VolumeFile file;
  const double before = bench::process_bytes("self", "VmRSS").value_or(0);
  bool is_good = is_loaded(file.header());
  const double peak = bench::process_bytes("self", "VmHWM").value_or(0) - before;
  bench::Slices ours;
  bench::Slices reference;
  bench::alternate(
      kFewSlices,
      [&] { ours.push_back(seconds_of([&] { is_good = is_loaded(file.header()) && is_good; })); },
      [&] {
        reference.push_back(seconds_of(
            [&] { is_good = reference_read_file(file.data()) == kDataBytes && is_good; }));
      });
  if (!is_good || !(peak > 0)) {
    std::fputs("bench_volume_load: the volume was not loaded\n", stderr);
    return 1;
  }
  constexpr double kMib = 1024.0 * 1024.0;
  bench::print(bench::compare("memory to load 2 GiB of 16-bit numbers", "MiB",
                              {bench::Goal::Of::Value, 256}, {peak / kMib}, {}));
  bench::print(bench::compare("time to load them, beside reading them", "s",
                              {bench::Goal::Of::Ratio, 10}, ours, reference));
  return 0;
}
