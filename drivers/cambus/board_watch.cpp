#include "drivers/cambus/board_watch.hpp"

namespace thimble::cambus {
namespace {

constexpr Duration kBeatGivenUp = std::chrono::milliseconds(page::kBeatGivenUp_ms);

std::uint32_t at(const IdentityWords& words, std::uint32_t offset) {
  return words[offset / sizeof(std::uint32_t)];
}

}  // namespace

IoStatus BoardWatch::check_identity(const IdentityWords& words) noexcept {
  if (at(words, page::kMagic) != page::kMagicValue) return give_up(Gone::Silent);
  if (at(words, page::kIncarnation) != incarnation_) return give_up(Gone::NewIncarnation);
  return status();
}

// As it only counts up, the beat was the same from when it was first seen to when it was asked for
// this time, at least, whether or not anybody looked meanwhile.
IoStatus BoardWatch::check_beat(const IdentityWords& words, MonotonicTime asked_at,
                                MonotonicTime now) noexcept {
  const std::uint32_t beat = at(words, page::kBeat);
  if (beat_ != beat) {
    beat_ = beat;
    beat_at_ = now;
  } else if (asked_at - beat_at_ >= kBeatGivenUp) {
    return give_up(Gone::NoBeat);
  }
  return status();
}

IoStatus BoardWatch::give_up(Gone why) noexcept {
  if (!is_gone()) gone_ = why;
  return status();
}

}  // namespace thimble::cambus
