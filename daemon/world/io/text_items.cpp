#include "daemon/world/io/text_items.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "daemon/world/io/quoted.hpp"
#include "daemon/world/io/text_number.hpp"

namespace thimble::world {
namespace {

// Ours: the longest double that a program prints has 24 characters.
constexpr std::size_t kMaxWordBytes = 64;

[[nodiscard]] bool is_blank(std::byte byte) noexcept {
  const auto c = std::to_integer<unsigned char>(byte);
  return c == ' ' || (c >= '\t' && c <= '\r');
}

// Takes the blanks; false at the end of the text.
[[nodiscard]] Result<bool> skip_blanks(BufferedSource& text) {
  for (;;) {
    const auto ahead = text.peek();
    if (!ahead) return tl::unexpected(ahead.error());
    if (ahead->empty()) return false;
    const auto* const word =
        std::find_if_not(ahead->data(), ahead->data() + ahead->size(), is_blank);
    const auto blanks = static_cast<std::size_t>(word - ahead->data());
    const bool is_found = blanks < ahead->size();
    text.take(blanks);
    if (is_found) return true;
  }
}

// One word, which may lie across two looks ahead. Empty at the end.
[[nodiscard]] Result<std::string> next_word(BufferedSource& text) {
  std::string word;
  const auto is_there = skip_blanks(text);
  if (!is_there) return tl::unexpected(is_there.error());
  while (*is_there) {
    const auto ahead = text.peek();
    if (!ahead) return tl::unexpected(ahead.error());
    const auto* const end = std::find_if(ahead->data(), ahead->data() + ahead->size(), is_blank);
    const auto count = static_cast<std::size_t>(end - ahead->data());
    const bool is_whole = count < ahead->size() || ahead->empty();
    word.append(reinterpret_cast<const char*>(ahead->data()), std::min(count, kMaxWordBytes + 1));
    text.take(count);
    if (is_whole || word.size() > kMaxWordBytes) break;
  }
  return word;
}

[[nodiscard]] int bits_of(ItemType type) noexcept { return static_cast<int>(8 * type.bytes); }

// As NRRD writes it, and what it can hold.
[[nodiscard]] std::string name_of(ItemType type) {
  if (type.kind == ItemKind::Float) return type.bytes == 8 ? "a double" : "a float";
  const int bits = bits_of(type);
  if (type.kind == ItemKind::Signed) {
    const std::int64_t high = std::numeric_limits<std::int64_t>::max() >> (64 - bits);
    return "an int" + std::to_string(bits) + ", whole from " + std::to_string(-high - 1) + " to " +
           std::to_string(high);
  }
  const std::uint64_t high = std::numeric_limits<std::uint64_t>::max() >> (64 - bits);
  return "a uint" + std::to_string(bits) + ", whole from 0 to " + std::to_string(high);
}

[[nodiscard]] bool can_hold(ItemType type, double value) noexcept {
  if (type.kind == ItemKind::Float) return true;
  const int bits = bits_of(type);
  const bool is_signed = type.kind == ItemKind::Signed;
  const double low = is_signed ? -std::ldexp(1.0, bits - 1) : 0;
  // The largest 64-bit numbers are rounded up to a power of two.
  const double high = std::ldexp(1.0, is_signed ? bits - 1 : bits) - (bits < 64 ? 1 : 0);
  return value == std::floor(value) && value >= low && value <= high;
}

}  // namespace

Result<void> read_text_items(BufferedSource& text, ItemType type, NumberSink& sink) {
  const std::uint64_t total = sink.items_left();
  while (sink.items_left() > 0) {
    const auto word = next_word(text);
    if (!word) return tl::unexpected(word.error());
    const auto place = [&] {
      return "data: number " + std::to_string(total - sink.items_left() + 1);
    };
    if (word->empty()) {
      return fail(Errc::Malformed, place() + " of " + std::to_string(total) + " is missing");
    }
    std::array<double, 1> value{};
    if (word->size() > kMaxWordBytes || !parse_number(*word, value[0]) ||
        !can_hold(type, value[0])) {
      return fail(Errc::Malformed,
                  place() + ": expected " + name_of(type) + ", found " + quoted(*word));
    }
    if (auto put = sink.put(value); !put) return put;
  }
  return {};
}

Result<bool> is_text_over(BufferedSource& text) {
  const auto is_there = skip_blanks(text);
  if (!is_there) return tl::unexpected(is_there.error());
  return !*is_there;
}

}  // namespace thimble::world
