#include "drivers/spacemouse/spacemouse_codec.hpp"

#include <algorithm>

namespace thimble::spacemouse {
namespace {

// `bytes` has at least six.
std::array<std::int16_t, 3> three_axes(std::span<const std::uint8_t> bytes) noexcept {
  std::array<std::int16_t, 3> axes{};
  for (std::size_t i = 0; i < axes.size(); ++i) {
    axes[i] = static_cast<std::int16_t>(bytes[2 * i] | bytes[2 * i + 1] << 8);
  }
  return axes;
}

std::uint32_t button_bits(std::span<const std::uint8_t> bytes) noexcept {
  std::uint32_t bits = 0;
  const std::size_t count = std::min(bytes.size(), sizeof bits);
  for (std::size_t i = 0; i < count; ++i) {
    bits |= static_cast<std::uint32_t>(bytes[i]) << (8 * i);
  }
  return bits;
}

}  // namespace

std::optional<PuckReport> parse_report(std::span<const std::uint8_t> bytes) noexcept {
  if (bytes.empty()) return std::nullopt;
  const std::span<const std::uint8_t> said = bytes.subspan(1);
  PuckReport report;
  switch (bytes[0]) {
    case wire::kTranslationReport:
      if (bytes.size() != wire::kSeparateBytes && bytes.size() != wire::kCombinedBytes) {
        return std::nullopt;
      }
      report.translation = three_axes(said);
      if (bytes.size() == wire::kCombinedBytes) report.rotation = three_axes(said.subspan(6));
      return report;
    case wire::kRotationReport:
      if (bytes.size() != wire::kSeparateBytes) return std::nullopt;
      report.rotation = three_axes(said);
      return report;
    case wire::kButtonReport:
      if (said.empty()) return std::nullopt;
      report.buttons = button_bits(said);
      return report;
    default:
      return report;
  }
}

}  // namespace thimble::spacemouse
