// Compiled once for each instruction set, by a file that defines THIMBLE_VECTOR_BYTES,
// THIMBLE_WORTH_OPS, THIMBLE_KERNELS and its name, and is compiled with that set's options. What it
// includes must hold no function that other files could share: the linker might give them one that
// their processor cannot run.
#pragma once

#ifdef __AVX512F__
#include <immintrin.h>  // each of its functions is inlined, whatever the options
#endif

#include "sim/model/cam/engine/vector_kernels.hpp"

namespace thimble::sim::cam {
namespace {

constexpr std::size_t kLanes = THIMBLE_VECTOR_BYTES / sizeof(Word);
constexpr std::size_t kShorts = THIMBLE_VECTOR_BYTES / sizeof(std::uint16_t);

using Vector [[gnu::vector_size(THIMBLE_VECTOR_BYTES)]] = Word;
using Shorts [[gnu::vector_size(THIMBLE_VECTOR_BYTES)]] = std::uint16_t;

Vector load(const Word* from) {
  Vector value;
  __builtin_memcpy(&value, from, sizeof value);
  return value;
}
void store(Word* to, Vector value) { __builtin_memcpy(to, &value, sizeof value); }

// Bit by bit, `a` where the mask is set, else `b`.
template <class V>
[[gnu::always_inline]] inline V choose(V mask, V a, V b) {
#ifdef __AVX512F__
  // One instruction, which neither compiler makes of the expression below.
  return reinterpret_cast<V>(_mm512_ternarylogic_epi64(reinterpret_cast<__m512i>(mask),
                                                       reinterpret_cast<__m512i>(a),
                                                       reinterpret_cast<__m512i>(b), 0xca));
#else
  return (a & mask) | (b & ~mask);
#endif
}

// --- 16 planes to 16-bit numbers and back: a square of 16 x 16 bits in each 16-bit lane is turned
// over its diagonal, so that v[k] has in lane m what site 16 m + k is. Its own inverse.

template <unsigned Distance>
[[gnu::always_inline]] inline void exchange(Shorts* v) {
  constexpr unsigned kMask = Distance == 8   ? 0x00ffU
                             : Distance == 4 ? 0x0f0fU
                             : Distance == 2 ? 0x3333U
                                             : 0x5555U;
  const Shorts low = Shorts{} + static_cast<std::uint16_t>(kMask);
#pragma GCC unroll 16
  for (unsigned i = 0; i < kPlanes; ++i) {
    if ((i & Distance) != 0) continue;
    const Shorts a = v[i];
    const Shorts b = v[i + Distance];
    v[i] = choose(low, a, b << Distance);
    v[i + Distance] = choose(low, a >> Distance, b);
  }
}

[[gnu::always_inline]] inline void transpose(Shorts* v) {
  exchange<8>(v);
  exchange<4>(v);
  exchange<2>(v);
  exchange<1>(v);
}

[[gnu::always_inline]] inline void load_planes(const Word* const* in, std::size_t at, Shorts* v) {
#pragma GCC unroll 16
  for (std::size_t plane = 0; plane < kPlanes; ++plane) {
    v[plane] = reinterpret_cast<Shorts>(load(in[plane] + at));
  }
}
[[gnu::always_inline]] inline void store_planes(const Shorts* v, std::size_t at, Word* const* out) {
#pragma GCC unroll 16
  for (std::size_t plane = 0; plane < kPlanes; ++plane) {
    store(out[plane] + at, reinterpret_cast<Vector>(v[plane]));
  }
}

// Four sites. Whole words in and out: the ports of the cache are what the table needs.
[[gnu::always_inline]] inline Word look_up(const std::uint16_t* table, Word sites) {
  return Word{table[sites & 0xffff]} | Word{table[sites >> 16 & 0xffff]} << 16 |
         Word{table[sites >> 32 & 0xffff]} << 32 | Word{table[sites >> 48]} << 48;
}

// What of a table that is waited for can be done meanwhile: the sites are looked up in eight parts,
// and each part is followed by a stage of turning other sites.
constexpr std::size_t kPart = kPlanes * kLanes / 8;

[[gnu::always_inline]] inline void look_up_part(const std::uint16_t* table, Word* sites,
                                                std::size_t part) {
  for (std::size_t i = part * kPart; i < (part + 1) * kPart; ++i)
    sites[i] = look_up(table, sites[i]);
}

[[gnu::always_inline]] inline void look_up_and_turn(const std::uint16_t* table, Word* sites,
                                                    std::size_t part, Shorts* turned) {
  look_up_part(table, sites, part);
  exchange<8>(turned);
  look_up_part(table, sites, part + 1);
  exchange<4>(turned);
  look_up_part(table, sites, part + 2);
  exchange<2>(turned);
  look_up_part(table, sites, part + 3);
  exchange<1>(turned);
}

// The table does not fit the first-level cache: while it is waited for, the sites before are turned
// back and the next ones turned.
void apply_table(const Word* const* in, const std::uint16_t* table, Word* const* out) {
  struct alignas(THIMBLE_VECTOR_BYTES) Sites {
    Word words[kPlanes * kLanes];
  };
  Sites buffers[3];
  Sites* now = &buffers[0];
  Sites* next = &buffers[1];
  Sites* before = &buffers[2];
  Shorts v[kPlanes];
  load_planes(in, 0, v);
  transpose(v);
  __builtin_memcpy(now, v, sizeof *now);
  __builtin_memset(before, 0, sizeof *before);
  for (std::size_t at = 0; at < kBlockWords; at += kLanes) {
    load_planes(in, at + kLanes < kBlockWords ? at + kLanes : 0, v);
    look_up_and_turn(table, now->words, 0, v);
    __builtin_memcpy(next, v, sizeof *next);
    __builtin_memcpy(v, before, sizeof *before);
    look_up_and_turn(table, now->words, 4, v);
    if (at > 0) store_planes(v, at - kLanes, out);
    Sites* const free = before;
    before = now;
    now = next;
    next = free;
  }
  __builtin_memcpy(v, before, sizeof *before);
  transpose(v);
  store_planes(v, kBlockWords - kLanes, out);
}

void to_sites(const Word* const* in, std::uint16_t* sites) {
  for (std::size_t at = 0; at < kBlockWords; at += kLanes, sites += kPlanes * kShorts) {
    Shorts v[kPlanes];
    load_planes(in, at, v);
    transpose(v);
    for (std::size_t i = 0; i < kPlanes * kShorts; ++i) sites[i] = v[i % kPlanes][i / kPlanes];
  }
}

void from_sites(const std::uint16_t* sites, Word* const* out) {
  for (std::size_t at = 0; at < kBlockWords; at += kLanes, sites += kPlanes * kShorts) {
    Shorts v[kPlanes];
    for (std::size_t i = 0; i < kPlanes * kShorts; ++i) v[i % kPlanes][i / kPlanes] = sites[i];
    transpose(v);
    store_planes(v, at, out);
  }
}

// --- Compiled rules. Eight vectors at a time are as many as stay in registers.

constexpr std::size_t kHeld = 8;
static_assert(kBlockWords % (kHeld * kLanes) == 0);

void run_ops(const PlaneOp* ops, std::size_t count, Word* const* blocks) {
  using Code = PlaneOp::Code;
  for (std::size_t at = 0; at < kBlockWords; at += kHeld * kLanes) {
    Vector acc[kHeld] = {};
    for (const PlaneOp* op = ops; op != ops + count; ++op) {
      Word* const a = blocks[op->a] + at;
      const Word* const b = blocks[op->b] + at;
      const auto each = [&](auto what) __attribute__((always_inline)) {
#pragma GCC unroll 8
        for (std::size_t i = 0; i < kHeld; ++i) acc[i] = what(acc[i], i * kLanes);
      };
      switch (op->code) {
        case Code::Zero:
          each([](Vector, std::size_t) { return Vector{}; });
          break;
        case Code::Load:
          each([&](Vector, std::size_t i) { return load(a + i); });
          break;
        case Code::Store:
          each([&](Vector x, std::size_t i) { return store(a + i, x), x; });
          break;
        case Code::StoreNot:
          each([&](Vector x, std::size_t i) { return store(a + i, ~x), x; });
          break;
        case Code::And:
          each([&](Vector x, std::size_t i) { return x & load(a + i); });
          break;
        case Code::AndNot:
          each([&](Vector x, std::size_t i) { return x & ~load(a + i); });
          break;
        case Code::NotAnd:
          each([&](Vector x, std::size_t i) { return ~x & load(a + i); });
          break;
        case Code::Or:
          each([&](Vector x, std::size_t i) { return x | load(a + i); });
          break;
        case Code::Xor:
          each([&](Vector x, std::size_t i) { return x ^ load(a + i); });
          break;
        case Code::MuxHigh:
          each([&](Vector x, std::size_t i) { return choose(load(a + i), x, load(b + i)); });
          break;
        case Code::MuxNotHigh:
          each([&](Vector x, std::size_t i) { return choose(load(a + i), ~x, load(b + i)); });
          break;
        case Code::MuxLow:
          each([&](Vector x, std::size_t i) { return choose(load(a + i), load(b + i), x); });
          break;
        case Code::MuxLowNot:
          each([&](Vector x, std::size_t i) { return choose(load(a + i), ~load(b + i), x); });
          break;
      }
    }
  }
}

// --- Kicks.

// Which lane goes where when the rows in a vector are turned by so many words.
Vector lanes_from(std::size_t row_words, std::size_t words) {
  Vector from{};
  for (std::size_t i = 0; i < kLanes; ++i) {
    from[i] = (i & ~(row_words - 1)) | ((i + words) & (row_words - 1));
  }
  return from;
}

[[gnu::always_inline]] inline Vector permuted(Vector v, Vector from) {
#ifdef __clang__
  Vector out{};  // clang 14 has no shuffle by numbers that are not constants
  for (std::size_t i = 0; i < kLanes; ++i) out[i] = v[from[i]];
  return out;
#else
  return __builtin_shuffle(v, from);
#endif
}

void rotate_rows(const Word* in, Word* out, std::size_t row_words, std::size_t words,
                 unsigned bits) {
  const Vector first = lanes_from(row_words, words);
  const Vector next = lanes_from(row_words, words + 1);
  const unsigned rest = static_cast<unsigned>(kWordSites) - bits;
  for (std::size_t at = 0; at < kBlockWords; at += kLanes) {
    const Vector v = load(in + at);
    const Vector low = permuted(v, first);
    store(out + at, bits == 0 ? low : (low >> bits) | (permuted(v, next) << rest));
  }
}

void shift_words(const Word* in, Word* out, std::size_t count, unsigned bits) {
  const unsigned rest = static_cast<unsigned>(kWordSites) - bits;
  std::size_t i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    store(out + i, (load(in + i) >> bits) | (load(in + i + 1) << rest));
  }
  for (; i < count; ++i) out[i] = in[i] >> bits | in[i + 1] << rest;
}

std::uint64_t count_ones(const Word* in, std::size_t count) {
  std::uint64_t ones = 0;
#pragma GCC unroll 8
  for (std::size_t i = 0; i < count; ++i) {
    ones += static_cast<std::uint64_t>(__builtin_popcountll(in[i]));
  }
  return ones;
}

}  // namespace

extern const VectorKernels THIMBLE_KERNELS;
const VectorKernels THIMBLE_KERNELS{.name = THIMBLE_KERNELS_NAME,
                                    .lanes = kLanes,
                                    .worth_ops = THIMBLE_WORTH_OPS,
                                    .apply_table = apply_table,
                                    .run_ops = run_ops,
                                    .rotate_rows = rotate_rows,
                                    .shift_words = shift_words,
                                    .count_ones = count_ones,
                                    .to_sites = to_sites,
                                    .from_sites = from_sites};

}  // namespace thimble::sim::cam
