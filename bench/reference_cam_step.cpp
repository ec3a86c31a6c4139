#include "bench/reference_cam_step.hpp"

#ifdef __x86_64__
#include <immintrin.h>
#endif

void reference_cam_step(const ReferenceCam& cam, const std::uint16_t* table,
                        const std::uint16_t* before, std::uint16_t* after, std::uint64_t* counts) {
  const int x_mask = (1 << cam.log2_x) - 1;
  const int y_mask = (1 << cam.log2_y) - 1;
  const int z_mask = (1 << cam.log2_z) - 1;
  for (int z = 0; z <= z_mask; ++z) {
    for (int y = 0; y <= y_mask; ++y) {
      for (int x = 0; x <= x_mask; ++x) {
        unsigned site = 0;
        for (unsigned layer = 0; layer < 16; ++layer) {
          const int* const kick = cam.kicks[layer];
          const int row = ((z - kick[2]) & z_mask) << cam.log2_y | ((y - kick[1]) & y_mask);
          const int from = row << cam.log2_x | ((x - kick[0]) & x_mask);
          site |= before[from] & 1U << layer;
        }
        const unsigned output = table[site];
        for (unsigned layer = 0; layer < 16; ++layer) counts[layer] += output >> layer & 1;
        after[(z << cam.log2_y | y) << cam.log2_x | x] = static_cast<std::uint16_t>(output);
      }
    }
  }
}

void reference_table_lookup(const std::uint16_t* table, const std::uint16_t* sites,
                            std::uint16_t* out, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) out[i] = table[sites[i]];
}

std::uint64_t reference_overlap(const std::uint64_t* shape, const std::uint64_t* const* parts,
                                std::size_t part_count, std::size_t words) {
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < words; ++i) {
    const std::size_t before = (i & ~std::size_t{7}) | ((i - 1) & 7);
    const std::uint64_t moved = shape[i] << 1 | shape[before] >> 63;
    std::uint64_t any = 0;
    for (std::size_t part = 0; part < part_count; ++part) any |= parts[part][i];
    count += static_cast<std::uint64_t>(__builtin_popcountll(moved & any));
  }
  return count;
}

#ifdef __x86_64__
__attribute__((target("avx512f,avx512bw"))) static void gather(const std::uint16_t* table,
                                                               const std::uint16_t* sites,
                                                               std::uint16_t* out,
                                                               std::size_t count) {
  for (std::size_t i = 0; i + 16 <= count; i += 16) {
    const __m256i packed = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(sites + i));
    const __m512i found = _mm512_mask_i32gather_epi32(
        _mm512_setzero_si512(), 0xffff, _mm512_maskz_cvtepu16_epi32(0xffff, packed), table, 2);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(out + i),
                        _mm512_maskz_cvtepi32_epi16(0xffff, found));
  }
}

bool reference_table_gather(const std::uint16_t* table, const std::uint16_t* sites,
                            std::uint16_t* out, std::size_t count) {
  if (!__builtin_cpu_supports("avx512f") || !__builtin_cpu_supports("avx512bw")) return false;
  gather(table, sites, out, count);
  return true;
}
#else
bool reference_table_gather(const std::uint16_t*, const std::uint16_t*, std::uint16_t*,
                            std::size_t) {
  return false;
}
#endif
