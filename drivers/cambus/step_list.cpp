#include "drivers/cambus/step_list.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "drivers/cambus/little_endian.hpp"

namespace thimble::cambus {
namespace {

std::span<const std::uint8_t> at(const WindowView& window, std::uint32_t offset) noexcept {
  return window.bytes.subspan(offset - window.base);
}

// Immediate data is two words, sent by turns.
std::uint16_t immediate_word(const Descriptor& step, std::uint32_t k) noexcept {
  return static_cast<std::uint16_t>(step.buffer >> (k % 2 == 0 ? 0 : 16));
}

}  // namespace

std::optional<Register> Descriptor::target() const noexcept {
  const std::uint32_t number = opcode & wire::kRegisterMask;
  if (number >= kRegisterCount) return std::nullopt;
  return static_cast<Register>(number);
}

std::uint64_t Descriptor::buffer_bytes() const noexcept {
  if (has(wire::kImmediate)) return 0;                      // a delay, too
  const bool is_bytes = is_read() && has(wire::kByteMode);  // a write sends words, flag or not
  return wire::buffer_end(is_bytes ? std::uint64_t{length} : 2 * std::uint64_t{length});
}

bool holds(const WindowView& window, std::uint32_t offset, std::uint64_t size) noexcept {
  if (offset % wire::kBufferAlignment != 0) return false;
  if (offset < wire::kReservedBytes || offset < window.base) return false;
  const std::uint64_t first = offset - window.base;
  return first <= window.bytes.size() && size <= window.bytes.size() - first;
}

std::optional<Descriptor> descriptor_at(const WindowView& window, std::uint32_t offset) noexcept {
  if (!holds(window, offset, wire::kDescriptorBytes)) return std::nullopt;
  const auto bytes = at(window, offset);
  return Descriptor{
      load32(bytes.subspan(wire::kOpcodeByte)), load32(bytes.subspan(wire::kBufferByte)),
      load32(bytes.subspan(wire::kLengthByte)), load32(bytes.subspan(wire::kLinkByte))};
}

std::uint16_t buffer_word(const WindowView& window, std::uint32_t buffer,
                          std::uint32_t k) noexcept {
  const auto bytes = at(window, buffer).subspan(2 * std::size_t{k});
  return static_cast<std::uint16_t>(bytes[0] | bytes[1] << 8);
}

std::optional<RegisterWords> register_words(const WindowView& window, const Descriptor& step) {
  const auto target = step.target();
  if (!target || step.is_delay() || step.is_read()) return std::nullopt;
  const std::uint32_t bits = facts_of(*target).bits;
  if (bits == 0 || step.length == 0 || step.length > bits) return std::nullopt;
  if (!step.is_immediate() && !holds(window, step.buffer, step.buffer_bytes())) return std::nullopt;
  RegisterWords words(*target);
  for (std::uint32_t k = 0; k < step.length; ++k) {
    words.words()[k] =
        step.is_immediate() ? immediate_word(step, k) : buffer_word(window, step.buffer, k);
  }
  return words;
}

std::string hex(std::uint32_t value) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  do {
    text.insert(text.begin(), kDigits[value % 16]);
    value /= 16;
  } while (value != 0);
  return "0x" + text;
}

std::vector<std::uint8_t> to_file(const StepList& list) {
  std::vector<std::uint8_t> file(list.base, 0);
  std::copy(wire::kFileMagic.begin(), wire::kFileMagic.end(), file.begin());
  store32(std::span(file).subspan(wire::kFileHeadByte), list.head);
  file.insert(file.end(), list.bytes.begin(), list.bytes.end());
  return file;
}

Result<StepList> parse_list_file(std::string_view file) {
  const std::string_view magic(wire::kFileMagic.data(), wire::kFileMagic.size());
  if (file.size() < wire::kReservedBytes || !file.starts_with(magic)) {
    return fail(Errc::Malformed, "this is no step list: it does not begin with CAMLIST1");
  }
  StepList list;
  std::vector<std::uint8_t> bytes(file.begin(), file.end());
  list.head = load32(std::span(bytes).subspan(wire::kFileHeadByte));
  list.bytes.assign(bytes.begin() + wire::kReservedBytes, bytes.end());
  return list;
}

}  // namespace thimble::cambus
