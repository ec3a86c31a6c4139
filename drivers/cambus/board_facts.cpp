#include "drivers/cambus/board_facts.hpp"

#include <algorithm>
#include <bit>
#include <string>

#include "drivers/cambus/cambus_wire.hpp"
#include "drivers/cambus/step_list.hpp"

namespace thimble::cambus {
namespace {

constexpr std::uint32_t kMostAlongAxis = 4;
// Ours: less than the smallest space needs, or a clock that nobody's memory has, is a mistake.
constexpr std::uint32_t kLeastLog2Sites = 4;
constexpr std::uint32_t kLeastClock_hz = 1'000'000;
constexpr std::uint32_t kMostClock_hz = 1'000'000'000;

std::uint32_t at(std::span<const std::uint32_t> words, std::uint32_t offset) {
  return words[offset / sizeof(std::uint32_t)];
}

tl::unexpected<Error> malformed(const std::string& what) {
  return fail(Errc::Malformed, "the board says " + what);
}

Result<BoardShape> parse_shape(std::uint32_t word) {
  BoardShape shape;
  for (std::size_t axis = 0; axis < shape.log2_modules.size(); ++axis) {
    const std::uint32_t modules = (word >> (8 * axis)) & 0xffU;
    if (modules > kMostAlongAxis || !std::has_single_bit(modules)) {
      return malformed("that it has " + std::to_string(modules) +
                       " modules along an axis, which can be 1, 2 or 4");
    }
    shape.log2_modules[axis] = std::countr_zero(modules);
  }
  const std::uint32_t log2_sites = word >> 24;
  if (log2_sites < kLeastLog2Sites || log2_sites > kAddressBits) {
    return malformed("that its modules have 2^" + std::to_string(log2_sites) + " sites");
  }
  shape.log2_sites = static_cast<int>(log2_sites);
  return shape;
}

bool is_window(std::uint32_t offset, std::uint32_t bytes, std::size_t bar_bytes) {
  if (offset % wire::kBufferAlignment != 0 || bytes % wire::kBufferAlignment != 0) return false;
  if (offset < page::kPageBytes || bytes <= wire::kReservedBytes) return false;
  return std::uint64_t{offset} + bytes <= bar_bytes;
}

}  // namespace

Result<BoardFacts> parse_board_facts(std::span<const std::uint32_t> words, std::size_t bar_bytes) {
  if (words.size_bytes() < page::kIdentityBytes || at(words, page::kMagic) != page::kMagicValue) {
    return fail(Errc::NotMine, "no CAM board answers: its page does not begin with CAM8");
  }
  BoardFacts facts;
  const std::uint32_t version = at(words, page::kVersion);
  if (version != page::kVersionValue) {
    return fail(Errc::Unsupported, "the board's page has version " + std::to_string(version) +
                                       ", and version 1 is known");
  }
  const auto shape = parse_shape(at(words, page::kShape));
  if (!shape) return tl::unexpected(shape.error());
  facts.shape = *shape;
  facts.clock_hz = at(words, page::kClockHz);
  if (facts.clock_hz < kLeastClock_hz || facts.clock_hz > kMostClock_hz) {
    return malformed("that its clock runs at " + std::to_string(facts.clock_hz) + " Hz");
  }
  facts.window_offset = at(words, page::kWindowOffset);
  facts.window_bytes = at(words, page::kWindowBytes);
  if (!is_window(facts.window_offset, facts.window_bytes, bar_bytes)) {
    return malformed("that its window has " + std::to_string(facts.window_bytes) + " bytes at " +
                     hex(facts.window_offset) + " of a BAR of " + std::to_string(bar_bytes));
  }
  facts.incarnation = at(words, page::kIncarnation);
  return facts;
}

BoardStatus parse_board_status(
    std::span<const std::uint32_t, page::kStatusBytes / 4> words) noexcept {
  constexpr std::size_t kFirstCount = (page::kRaised - page::kRead) / 4;
  BoardStatus status;
  std::copy_n(words.begin(), status.registers.size(), status.registers.begin());
  status.acknowledged = words[(page::kAcknowledge - page::kRead) / 4];
  std::copy_n(words.begin() + kFirstCount, status.raised.size(), status.raised.begin());
  return status;
}

}  // namespace thimble::cambus
