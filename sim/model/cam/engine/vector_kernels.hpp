#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace thimble::sim::cam {

// The inner loops of the fast engines, over bit planes: bit n of word w of a plane is site 64 w +
// n. They work on blocks of so many words of each plane, small enough that all of them stay in the
// first-level cache. Nothing here allocates, checks or fails.
using Word = std::uint64_t;
inline constexpr std::size_t kWordSites = 64;
inline constexpr std::size_t kBlockWords = 64;
inline constexpr std::size_t kBlockSites = kBlockWords * kWordSites;
inline constexpr std::size_t kPlanes = 16;

// An operation of a compiled rule on whole blocks: `a` and `b` are numbers of blocks, `acc` is what
// the operation before left.
struct PlaneOp {
  enum class Code : std::uint8_t {
    Zero,        // acc = 0
    Load,        // acc = a
    Store,       // a = acc
    StoreNot,    // a = ~acc
    And,         // acc & a
    AndNot,      // acc & ~a
    NotAnd,      // ~acc & a
    Or,          // acc | a
    Xor,         // acc ^ a
    MuxHigh,     // a ? acc : b
    MuxNotHigh,  // a ? ~acc : b
    MuxLow,      // a ? b : acc
    MuxLowNot,   // a ? ~b : acc
  };
  Code code{Code::Zero};
  std::uint16_t a{0};
  std::uint16_t b{0};
};

// One instruction set's. `Word` pointers need no alignment beyond a word's own; 64 bytes are best.
struct VectorKernels {
  const char* name;
  std::size_t lanes;      // words of a vector
  std::size_t worth_ops;  // a rule of more takes longer than the table (docs/decisions/0378)

  // One block: the 16 bits of each site to its entry of the table, and the entry's bits to `out`.
  void (*apply_table)(const Word* const* in, const std::uint16_t* table, Word* const* out);
  // One block through a compiled rule.
  void (*run_ops)(const PlaneOp* ops, std::size_t count, Word* const* blocks);
  // Rows of `row_words` (a power of two, at most `lanes`): word i of a row becomes the row's 64
  // bits from 64 * words + bits on, around its end. One block.
  void (*rotate_rows)(const Word* in, Word* out, std::size_t row_words, std::size_t words,
                      unsigned bits);
  // out[i] has the bits from `bits` (1 to 63) on of in[i] and in[i + 1].
  void (*shift_words)(const Word* in, Word* out, std::size_t count, unsigned bits);
  std::uint64_t (*count_ones)(const Word* in, std::size_t count);
  // A block to 4096 sites, and back.
  void (*to_sites)(const Word* const* in, std::uint16_t* sites);
  void (*from_sites)(const std::uint16_t* sites, Word* const* out);
};

// Those that this build has and this processor can run, the fastest first; never none: the last is
// the build's own instruction set.
[[nodiscard]] std::span<const VectorKernels* const> usable_kernels();
// All that this build has, whether this processor can run them or not.
[[nodiscard]] std::span<const VectorKernels* const> built_kernels();

}  // namespace thimble::sim::cam
