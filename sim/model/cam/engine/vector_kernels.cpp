#include "sim/model/cam/engine/vector_kernels.hpp"

#include <array>
#include <bit>
#include <vector>

namespace thimble::sim::cam {

static_assert(std::endian::native == std::endian::little,
              "16-bit parts of a word are taken for its bits in ascending order");

extern const VectorKernels kBaselineKernels;
#ifdef THIMBLE_HAS_X86_KERNELS
extern const VectorKernels kAvx2Kernels;
extern const VectorKernels kAvx512Kernels;
#endif

namespace {

#ifdef THIMBLE_HAS_X86_KERNELS
constexpr std::array<const VectorKernels*, 3> kBuilt{&kAvx512Kernels, &kAvx2Kernels,
                                                     &kBaselineKernels};
bool can_run(const VectorKernels* kernels) {
  if (kernels == &kAvx2Kernels) return __builtin_cpu_supports("avx2") != 0;
  if (kernels != &kAvx512Kernels) return true;
  return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
         __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0;
}
#else
constexpr std::array<const VectorKernels*, 1> kBuilt{&kBaselineKernels};
bool can_run(const VectorKernels*) { return true; }
#endif

std::vector<const VectorKernels*> find_usable() {
  std::vector<const VectorKernels*> usable;
  for (const VectorKernels* kernels : kBuilt) {
    if (can_run(kernels)) usable.push_back(kernels);
  }
  return usable;
}

}  // namespace

std::span<const VectorKernels* const> usable_kernels() {
  static const std::vector<const VectorKernels*> kUsable = find_usable();
  return kUsable;
}

std::span<const VectorKernels* const> built_kernels() { return kBuilt; }

}  // namespace thimble::sim::cam
