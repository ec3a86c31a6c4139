#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/cambus/cambus_registers.hpp"
#include "drivers/cambus/cambus_wire.hpp"
#include "drivers/cambus/register_words.hpp"
#include "hal/base/result.hpp"

namespace thimble::cambus {

// Bytes of a board's window as lists see them: `bytes` begin at offset `base`.
struct WindowView {
  std::uint32_t base{0};
  std::span<const std::uint8_t> bytes;
};

// Enough after any write to scan-io: with the longest refresh that scan-format can ask for, as a
// list does not say which one is in force in which module.
inline constexpr std::uint32_t kLongestFlush_clocks =
    wire::kFlushClocks + wire::kClocksPerRefresh * ((1U << field::kRefreshLength.bits) - 1U) +
    2 * wire::kBusLevels;

struct Descriptor {
  std::uint32_t opcode{0};
  std::uint32_t buffer{0};  // offset in the window, or immediate data
  std::uint32_t length{0};
  std::uint32_t link{0};

  [[nodiscard]] bool has(std::uint32_t flag) const noexcept { return (opcode & flag) == flag; }
  [[nodiscard]] bool is_delay() const noexcept { return has(wire::kDelay); }
  [[nodiscard]] bool is_read() const noexcept { return has(wire::kRead) && !is_delay(); }
  [[nodiscard]] bool is_immediate() const noexcept { return has(wire::kImmediate) && !is_delay(); }
  // Nothing when the list names a register that is not there.
  [[nodiscard]] std::optional<Register> target() const noexcept;
  // What its buffer takes, to the end of the last alignment; 0 without one.
  [[nodiscard]] std::uint64_t buffer_bytes() const noexcept;
  bool operator==(const Descriptor&) const = default;
};

// Whether `size` bytes at an offset lie in the view, aligned and not reserved.
[[nodiscard]] bool holds(const WindowView& window, std::uint32_t offset,
                         std::uint64_t size) noexcept;
// Nothing when it does not lie in the view.
[[nodiscard]] std::optional<Descriptor> descriptor_at(const WindowView& window,
                                                      std::uint32_t offset) noexcept;
// What a write sends to a register of fixed length; nothing when its length or buffer is wrong.
[[nodiscard]] std::optional<RegisterWords> register_words(const WindowView& window,
                                                          const Descriptor& step);
// The k-th word of a buffer that lies in the view.
[[nodiscard]] std::uint16_t buffer_word(const WindowView& window, std::uint32_t buffer,
                                        std::uint32_t k) noexcept;

// A list ready to be put into a window: its bytes lie from `base` on, its first descriptor at
// `head`.
struct StepList {
  std::uint32_t base{wire::kReservedBytes};
  std::uint32_t head{wire::kReservedBytes};
  std::vector<std::uint8_t> bytes;

  [[nodiscard]] WindowView view() const noexcept { return {base, bytes}; }
};

// As offsets are written in messages: "0x40".
[[nodiscard]] std::string hex(std::uint32_t value);

// The file of a list (docs/cambus.md, section 3), and back.
// Errors: Malformed when the file does not begin as one.
[[nodiscard]] std::vector<std::uint8_t> to_file(const StepList& list);
[[nodiscard]] Result<StepList> parse_list_file(std::string_view file);

}  // namespace thimble::cambus
