#include "daemon/world/io/npy_header.hpp"

#include <algorithm>
#include <bit>
#include <string>

#include "daemon/world/io/quoted.hpp"
#include "daemon/world/voxel_grid.hpp"

namespace thimble::world {
namespace {

// Reads the one Python literal that the header may be: a dict of strings, booleans and tuples.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : rest_(text) {}

  void skip_space() noexcept {
    const auto start = rest_.find_first_not_of(" \t\r\n");
    rest_.remove_prefix(start == std::string_view::npos ? rest_.size() : start);
  }
  // Takes `token` after blanks; false leaves everything after the blanks.
  bool take(std::string_view token) noexcept {
    skip_space();
    if (!rest_.starts_with(token)) return false;
    rest_.remove_prefix(token.size());
    return true;
  }
  [[nodiscard]] bool is_next(std::string_view token) noexcept {
    skip_space();
    return rest_.starts_with(token);
  }
  [[nodiscard]] bool is_at_end() noexcept {
    skip_space();
    return rest_.empty();
  }
  bool take_string(std::string_view& out) noexcept {
    skip_space();
    if (!rest_.starts_with('\'') && !rest_.starts_with('"')) return false;
    const auto end = rest_.find(rest_.front(), 1);
    if (end == std::string_view::npos) return false;
    out = rest_.substr(1, end - 1);
    rest_.remove_prefix(end + 1);
    return out.find_first_of("\\\n") == std::string_view::npos;
  }
  // Decimal digits; Python 2 wrote an L behind long ones.
  bool take_digits(std::string_view& out) noexcept {
    skip_space();
    const auto end = std::min(rest_.find_first_not_of("0123456789"), rest_.size());
    out = rest_.substr(0, end);
    rest_.remove_prefix(end);
    if (end != 0 && rest_.starts_with('L')) rest_.remove_prefix(1);
    return end != 0;
  }
  [[nodiscard]] std::string here() const { return rest_.empty() ? "the end" : quoted(rest_); }

 private:
  std::string_view rest_;
};

[[nodiscard]] tl::unexpected<Error> malformed(std::string message) {
  return fail(Errc::Malformed, std::move(message));
}

[[nodiscard]] Result<void> parse_descr(Scanner& scanner, NpyHeader& header) {
  if (scanner.is_next("[") || scanner.is_next("(")) {
    return fail(Errc::Unsupported, "descr: a structured type, expected one plain number a cell");
  }
  std::string_view descr;
  if (!scanner.take_string(descr)) {
    return malformed("descr: expected a string, found " + scanner.here());
  }
  std::string_view type = descr;
  bool is_big_endian = std::endian::native == std::endian::big;
  if (!type.empty() && std::string_view("<>|=").find(type.front()) != std::string_view::npos) {
    if (type.front() == '<' || type.front() == '>') is_big_endian = type.front() == '>';
    type.remove_prefix(1);
  }
  constexpr std::array<std::pair<std::string_view, ItemKind>, 12> kTypes{{
      {"b1", ItemKind::Bool},
      {"i1", ItemKind::Signed},
      {"i2", ItemKind::Signed},
      {"i4", ItemKind::Signed},
      {"i8", ItemKind::Signed},
      {"u1", ItemKind::Unsigned},
      {"u2", ItemKind::Unsigned},
      {"u4", ItemKind::Unsigned},
      {"u8", ItemKind::Unsigned},
      {"f2", ItemKind::Float},
      {"f4", ItemKind::Float},
      {"f8", ItemKind::Float},
  }};
  const auto* known = std::find_if(kTypes.begin(), kTypes.end(),
                                   [&](const auto& entry) { return entry.first == type; });
  if (known == kTypes.end()) {
    const bool is_object = type.starts_with('O');
    return fail(Errc::Unsupported, "descr: " + quoted(descr) + (is_object ? " (objects)" : "") +
                                       " is not among b1, i1 to i8, u1 to u8, f2 to f8");
  }
  header.kind = known->second;
  header.item_bytes = static_cast<std::uint32_t>(type[1] - '0');
  header.is_big_endian = is_big_endian;
  return {};
}

[[nodiscard]] Result<void> parse_order(Scanner& scanner, NpyHeader& header) {
  header.is_fortran_order = scanner.take("True");
  if (header.is_fortran_order || scanner.take("False")) return {};
  return malformed("fortran_order: expected True or False, found " + scanner.here());
}

[[nodiscard]] Result<std::uint32_t> parse_dimension(Scanner& scanner, const std::string& field) {
  if (scanner.is_next("-")) return malformed(field + ": is negative");
  std::string_view digits;
  if (!scanner.take_digits(digits)) {
    return malformed(field + ": expected a whole number, found " + scanner.here());
  }
  std::uint32_t value = 0;
  for (const char digit : digits) {
    value = value * 10 + static_cast<std::uint32_t>(digit - '0');
    if (value <= VoxelGrid::kMaxCellsPerAxis) continue;
    return fail(Errc::TooLarge, field + ": " + std::string(digits.substr(0, 24)) +
                                    " cells; the limit is " +
                                    std::to_string(VoxelGrid::kMaxCellsPerAxis));
  }
  if (value == 0) return malformed(field + ": is 0; a world has at least 1 cell along each axis");
  return value;
}

[[nodiscard]] Result<void> parse_shape(Scanner& scanner, NpyHeader& header) {
  if (!scanner.take("(")) return malformed("shape: expected a tuple, found " + scanner.here());
  std::size_t count = 0;
  while (!scanner.take(")")) {
    if (count == header.shape.size()) {
      return fail(Errc::Unsupported, "shape: has more than 3 dimensions, expected 3");
    }
    const auto value = parse_dimension(scanner, "shape[" + std::to_string(count) + "]");
    if (!value) return tl::unexpected(value.error());
    header.shape[count++] = *value;
    if (!scanner.take(",") && !scanner.is_next(")")) {
      return malformed("shape: expected , or ), found " + scanner.here());
    }
  }
  if (count == header.shape.size()) return {};
  return fail(Errc::Unsupported, "shape: has " + std::to_string(count) + " dimensions, expected 3");
}

}  // namespace

Result<NpyPreamble> parse_npy_preamble(std::span<const std::byte> bytes) {
  constexpr std::array<unsigned char, 6> kMagic{0x93, 'N', 'U', 'M', 'P', 'Y'};
  const auto at = [&](std::size_t i) { return std::to_integer<std::uint32_t>(bytes[i]); };
  for (std::size_t i = 0; i < kMagic.size(); ++i) {
    if (i < bytes.size() && at(i) == kMagic[i]) continue;
    return malformed("magic: not a NumPy .npy file");
  }
  if (bytes.size() < 8) return malformed("version: the file ends before it");
  if (at(6) < 1 || at(6) > 3 || at(7) != 0) {
    return fail(Errc::Unsupported, "version: " + std::to_string(at(6)) + "." +
                                       std::to_string(at(7)) + " is not 1.0, 2.0 or 3.0");
  }
  NpyPreamble preamble;
  preamble.preamble_bytes = at(6) == 1 ? 10 : 12;
  if (bytes.size() < preamble.preamble_bytes) {
    return malformed("header length: the file ends before it");
  }
  for (std::size_t i = preamble.preamble_bytes; i-- > 8;) {
    preamble.text_bytes = preamble.text_bytes << 8 | at(i);
  }
  if (preamble.text_bytes > kNpyMaxTextBytes) {
    return fail(Errc::TooLarge, "header length: " + std::to_string(preamble.text_bytes) +
                                    " bytes; the limit is " + std::to_string(kNpyMaxTextBytes));
  }
  return preamble;
}

Result<NpyHeader> parse_npy_text(std::string_view text) {
  struct Field {
    std::string_view name;
    Result<void> (*parse)(Scanner&, NpyHeader&);
    bool is_seen;
  };
  std::array<Field, 3> fields{{{"descr", parse_descr, false},
                               {"fortran_order", parse_order, false},
                               {"shape", parse_shape, false}}};
  NpyHeader header;
  Scanner scanner(text);
  if (!scanner.take("{")) return malformed("header: expected {, found " + scanner.here());
  while (!scanner.take("}")) {
    std::string_view name;
    if (!scanner.take_string(name)) {
      return malformed("header: expected a key, found " + scanner.here());
    }
    auto* field = std::find_if(fields.begin(), fields.end(),
                               [&](const Field& candidate) { return candidate.name == name; });
    if (field == fields.end()) return malformed("header: unknown key " + quoted(name));
    if (field->is_seen) return malformed("header: key " + quoted(name) + " comes twice");
    field->is_seen = true;
    if (!scanner.take(":")) return malformed("header: expected :, found " + scanner.here());
    if (auto parsed = field->parse(scanner, header); !parsed) return tl::unexpected(parsed.error());
    if (!scanner.take(",") && !scanner.is_next("}")) {
      return malformed("header: expected , or }, found " + scanner.here());
    }
  }
  if (!scanner.is_at_end()) return malformed("header: after the } comes " + scanner.here());
  for (const Field& field : fields) {
    if (!field.is_seen) return malformed("header: the key " + quoted(field.name) + " is missing");
  }
  return header;
}

}  // namespace thimble::world
