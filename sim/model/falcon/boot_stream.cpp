#include "sim/model/falcon/boot_stream.hpp"

namespace thimble::sim {
namespace {

constexpr std::uint16_t kKey = 0x08aa;
constexpr std::size_t kHeadWords = 11;  // key, eight reserved, entry point
constexpr std::size_t kAddressWords = 2;

}  // namespace

void BootStream::take(std::uint8_t byte) noexcept {
  if (state_ != State::Reading) return;
  ++bytes_;
  if (bytes_ % 2 != 0) {
    low_ = byte;
    return;
  }
  take_word(static_cast<std::uint16_t>(low_ | byte << 8U));
}

void BootStream::take_word(std::uint16_t word) noexcept {
  ++words_in_part_;
  const auto go_to = [this](Part next) noexcept {
    part_ = next;
    words_in_part_ = 0;
  };
  switch (part_) {
    case Part::Head:
      if (words_in_part_ == 1 && word != kKey) state_ = State::Refused;
      if (words_in_part_ == kHeadWords) go_to(Part::Size);
      return;
    case Part::Size:
      block_words_ = word;
      if (word == 0) state_ = State::Complete;
      return go_to(Part::Address);
    case Part::Address:
      if (words_in_part_ == kAddressWords) go_to(Part::Data);
      return;
    case Part::Data:
      if (words_in_part_ == block_words_) go_to(Part::Size);
      return;
  }
}

}  // namespace thimble::sim
