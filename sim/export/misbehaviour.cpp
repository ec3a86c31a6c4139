#include "sim/export/misbehaviour.hpp"

#include <algorithm>

namespace thimble::sim {
namespace {

// True for as long as there is something left to do.
bool count_down(std::uint32_t& left, std::uint64_t& done) noexcept {
  if (left == 0) return false;
  --left;
  ++done;
  return true;
}

}  // namespace

bool Misbehaviour::halts(bool is_in) noexcept {
  const bool halts = count_down(halt_, struck_.halted);
  if (halts && !is_in) ++struck_.halted_out;
  return halts;
}

std::size_t Misbehaviour::spoil(std::span<std::uint8_t> room, std::size_t size) noexcept {
  if (size == 0 || size > room.size()) return size;
  if (count_down(corrupt_, struck_.corrupted)) {
    const std::uint64_t flips = 1 + random_() % 8;
    for (std::uint64_t i = 0; i < flips; ++i) {
      const std::uint64_t bit = random_() % (size * 8);
      room[bit / 8] = static_cast<std::uint8_t>(room[bit / 8] ^ (1U << bit % 8));
    }
  }
  if (count_down(short_, struck_.shortened)) size /= 2;
  if (count_down(babble_, struck_.babbled)) {
    const std::size_t more = std::min(2 * size + 1, room.size());
    for (std::size_t i = size; i < more; ++i) room[i] = static_cast<std::uint8_t>(random_());
    size = more > size ? more : room.size() + 1;
  }
  return size;
}

void Misbehaviour::note_taken(std::span<const std::uint8_t> sent) noexcept {
  if (!sent.empty()) count_down(cut_, struck_.cut);
}

}  // namespace thimble::sim
