#include "daemon/world/cam/automaton_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <optional>

#include "daemon/world/io/nrrd_header.hpp"
#include "daemon/world/io/nrrd_write.hpp"

namespace thimble::world::cam {
namespace {

constexpr std::string_view kRuleKey = "thimble_rule:=";
constexpr std::string_view kStepsKey = "thimble_steps:=";
constexpr std::size_t kMaxRuleBytes = 32;

// What stands behind the first such key in the lines of a header.
[[nodiscard]] std::optional<std::string_view> find_value(std::string_view header,
                                                         std::string_view key) {
  while (!header.empty()) {
    std::string_view line = header.substr(0, header.find('\n'));
    header.remove_prefix(std::min(header.size(), line.size() + 1));
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.starts_with(key)) return line.substr(key.size());
  }
  return std::nullopt;
}

[[nodiscard]] bool is_rule_name(std::string_view text) {
  return !text.empty() && text.size() <= kMaxRuleBytes &&
         std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
         });
}

[[nodiscard]] Result<void> read_keys(std::string_view header, AutomatonState& state) {
  const auto rule = find_value(header, kRuleKey);
  const auto steps = find_value(header, kStepsKey);
  if (!rule || !steps) {
    return fail(Errc::Unsupported, "no state of a live world: its header does not say the rule");
  }
  const auto [end, error] =
      std::from_chars(steps->data(), steps->data() + steps->size(), state.steps);
  if (!is_rule_name(*rule) || error != std::errc{} || end != steps->data() + steps->size()) {
    return fail(Errc::Malformed, "thimble_rule, thimble_steps: expected a name and a number");
  }
  state.rule = *rule;
  return {};
}

[[nodiscard]] Result<void> read_sites(const NrrdHeader& header, std::string_view data,
                                      AutomatonState& state) {
  if (header.type != ItemType{ItemKind::Unsigned, 2, false} ||
      header.encoding != NrrdEncoding::Raw || !header.data_file.empty() || header.line_skip != 0 ||
      header.byte_skip != 0) {
    return fail(Errc::Unsupported,
                "expected raw cells of type uint16, little-endian, right behind the header");
  }
  std::uint64_t cells = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!std::has_single_bit(header.sizes[axis])) {
      return fail(Errc::Malformed, "sizes: expected powers of two");
    }
    state.log2_cells[axis] = std::countr_zero(header.sizes[axis]);
    cells *= header.sizes[axis];
  }
  if (data.size() != 2 * cells) {
    return fail(Errc::Malformed, "data: expected " + std::to_string(2 * cells) + " bytes, found " +
                                     std::to_string(data.size()));
  }
  state.sites.resize(static_cast<std::size_t>(cells));
  for (std::size_t i = 0; i < state.sites.size(); ++i) {
    const auto low = static_cast<unsigned char>(data[2 * i]);
    const auto high = static_cast<unsigned char>(data[2 * i + 1]);
    state.sites[i] = static_cast<std::uint16_t>(low | high << 8);
  }
  return {};
}

}  // namespace

std::string to_nrrd(const AutomatonState& state) {
  std::array<std::uint32_t, 3> sizes{};
  for (std::size_t axis = 0; axis < 3; ++axis) sizes[axis] = 1U << state.log2_cells[axis];
  std::string keys = std::string(kRuleKey) + state.rule + "\n";
  keys += std::string(kStepsKey) + std::to_string(state.steps) + "\n";
  std::string file = nrrd_head("uint16", sizes, keys);
  for (const std::uint16_t site : state.sites) {
    file += static_cast<char>(site & 0xff);
    file += static_cast<char>(site >> 8);
  }
  return file;
}

Result<AutomatonState> parse_state(std::string_view bytes) {
  if (bytes.size() > kMaxStateBytes) {
    return fail(Errc::TooLarge, "larger than any state of a live world");
  }
  const auto header = parse_nrrd_header(bytes, true);
  if (!header) return tl::unexpected(header.error());
  AutomatonState state;
  if (const auto read = read_keys(bytes.substr(0, header->header_bytes), state); !read) {
    return tl::unexpected(read.error());
  }
  const auto read = read_sites(*header, bytes.substr(header->header_bytes), state);
  if (!read) return tl::unexpected(read.error());
  return state;
}

}  // namespace thimble::world::cam
