#include "daemon/world/io/nrrd_fields.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "daemon/world/io/quoted.hpp"
#include "daemon/world/io/text_number.hpp"
#include "daemon/world/voxel_grid.hpp"

namespace thimble::world {
namespace {

constexpr std::string_view kBlanks = " \t";

[[nodiscard]] tl::unexpected<Error> malformed(std::string message) {
  return fail(Errc::Malformed, std::move(message));
}
[[nodiscard]] tl::unexpected<Error> unsupported(std::string message) {
  return fail(Errc::Unsupported, std::move(message));
}

[[nodiscard]] std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  for (;;) {
    const auto start = text.find_first_not_of(kBlanks);
    if (start == std::string_view::npos) return words;
    text.remove_prefix(start);
    const auto end = std::min(text.find_first_of(kBlanks), text.size());
    words.push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
}

// Most strings of the format are the same in either case; words are parted by one blank.
[[nodiscard]] std::string plain(std::string_view text) {
  std::string out;
  for (const std::string_view word : words_of(text)) {
    if (!out.empty()) out += ' ';
    for (const char c : word) out += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return out;
}

// One for each axis.
[[nodiscard]] Result<std::array<std::string_view, 3>> three_of(const char* field,
                                                               std::string_view value) {
  const auto words = words_of(value);
  if (words.size() != 3) {
    return malformed(std::string(field) + ": has " + std::to_string(words.size()) +
                     " entries, expected 3");
  }
  return std::array<std::string_view, 3>{words[0], words[1], words[2]};
}

[[nodiscard]] Result<double> length_of_vector(std::string_view text, const std::string& field) {
  std::size_t count = 0;
  double length = 0;
  while (!text.empty()) {
    const auto end = std::min(text.find(','), text.size());
    const auto words = words_of(text.substr(0, end));
    double value = 0;
    if (words.size() != 1 || !parse_number(words[0], value)) {
      return malformed(field + ": expected (number,number,number), found " + quoted(text));
    }
    length = std::hypot(length, value);
    ++count;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  if (std::isinf(length)) return malformed(field + ": is longer than a number can say");
  if (count == 0 || !(length > 0)) {
    return malformed(field + ": has no length greater than 0");
  }
  return length;
}

struct TypeName {
  std::string_view name;
  ItemKind kind;
  std::uint32_t bytes;
};
constexpr std::array kTypes{
    TypeName{"signed char", ItemKind::Signed, 1},
    TypeName{"int8", ItemKind::Signed, 1},
    TypeName{"int8_t", ItemKind::Signed, 1},
    TypeName{"uchar", ItemKind::Unsigned, 1},
    TypeName{"unsigned char", ItemKind::Unsigned, 1},
    TypeName{"uint8", ItemKind::Unsigned, 1},
    TypeName{"uint8_t", ItemKind::Unsigned, 1},
    TypeName{"short", ItemKind::Signed, 2},
    TypeName{"short int", ItemKind::Signed, 2},
    TypeName{"signed short", ItemKind::Signed, 2},
    TypeName{"signed short int", ItemKind::Signed, 2},
    TypeName{"int16", ItemKind::Signed, 2},
    TypeName{"int16_t", ItemKind::Signed, 2},
    TypeName{"ushort", ItemKind::Unsigned, 2},
    TypeName{"unsigned short", ItemKind::Unsigned, 2},
    TypeName{"unsigned short int", ItemKind::Unsigned, 2},
    TypeName{"uint16", ItemKind::Unsigned, 2},
    TypeName{"uint16_t", ItemKind::Unsigned, 2},
    TypeName{"int", ItemKind::Signed, 4},
    TypeName{"signed int", ItemKind::Signed, 4},
    TypeName{"int32", ItemKind::Signed, 4},
    TypeName{"int32_t", ItemKind::Signed, 4},
    TypeName{"uint", ItemKind::Unsigned, 4},
    TypeName{"unsigned int", ItemKind::Unsigned, 4},
    TypeName{"uint32", ItemKind::Unsigned, 4},
    TypeName{"uint32_t", ItemKind::Unsigned, 4},
    TypeName{"longlong", ItemKind::Signed, 8},
    TypeName{"long long", ItemKind::Signed, 8},
    TypeName{"long long int", ItemKind::Signed, 8},
    TypeName{"signed long long", ItemKind::Signed, 8},
    TypeName{"signed long long int", ItemKind::Signed, 8},
    TypeName{"int64", ItemKind::Signed, 8},
    TypeName{"int64_t", ItemKind::Signed, 8},
    TypeName{"ulonglong", ItemKind::Unsigned, 8},
    TypeName{"unsigned long long", ItemKind::Unsigned, 8},
    TypeName{"unsigned long long int", ItemKind::Unsigned, 8},
    TypeName{"uint64", ItemKind::Unsigned, 8},
    TypeName{"uint64_t", ItemKind::Unsigned, 8},
    TypeName{"float", ItemKind::Float, 4},
    TypeName{"double", ItemKind::Float, 8},
};

}  // namespace

struct NrrdFields::Reader {
  std::string_view name;  // without its blanks, which may be left out
  Result<void> (NrrdFields::*read)(std::string_view);
};

Result<void> NrrdFields::read(std::string_view name, std::string_view value) {
  static constexpr std::array kReaders{
      Reader{"type", &NrrdFields::read_type},
      Reader{"dimension", &NrrdFields::read_dimension},
      Reader{"sizes", &NrrdFields::read_sizes},
      Reader{"encoding", &NrrdFields::read_encoding},
      Reader{"endian", &NrrdFields::read_endian},
      Reader{"spacings", &NrrdFields::read_spacings},
      Reader{"spacedirections", &NrrdFields::read_directions},
      Reader{"axismins", &NrrdFields::read_bounds},
      Reader{"axismaxs", &NrrdFields::read_bounds},
      Reader{"kinds", &NrrdFields::read_kinds},
      Reader{"lineskip", &NrrdFields::read_line_skip},
      Reader{"byteskip", &NrrdFields::read_byte_skip},
      Reader{"datafile", &NrrdFields::read_data_file},
      // Nothing that a finger could feel.
      Reader{"blocksize", &NrrdFields::ignore},
      Reader{"content", &NrrdFields::ignore},
      Reader{"number", &NrrdFields::ignore},
      Reader{"min", &NrrdFields::ignore},
      Reader{"max", &NrrdFields::ignore},
      Reader{"oldmin", &NrrdFields::ignore},
      Reader{"oldmax", &NrrdFields::ignore},
      Reader{"sampleunits", &NrrdFields::ignore},
      Reader{"space", &NrrdFields::ignore},
      Reader{"spacedimension", &NrrdFields::ignore},
      Reader{"spaceunits", &NrrdFields::ignore},
      Reader{"spaceorigin", &NrrdFields::ignore},
      Reader{"measurementframe", &NrrdFields::ignore},
      Reader{"thicknesses", &NrrdFields::ignore},
      Reader{"centers", &NrrdFields::ignore},
      Reader{"centerings", &NrrdFields::ignore},
      Reader{"labels", &NrrdFields::ignore},
      Reader{"units", &NrrdFields::ignore},
  };
  std::string key = plain(name);
  key.erase(std::remove(key.begin(), key.end(), ' '), key.end());
  const auto* known = std::find_if(kReaders.begin(), kReaders.end(),
                                   [&](const Reader& reader) { return reader.name == key; });
  if (known == kReaders.end()) return malformed("header: unknown field " + quoted(name));
  if (!seen_.insert(key).second) return malformed(plain(name) + ": comes twice");
  return (this->*known->read)(value);
}

Result<NrrdHeader> NrrdFields::finish() const {
  for (const char* field : {"type", "dimension", "sizes", "encoding"}) {
    if (!seen_.contains(field)) return malformed(std::string(field) + ": is missing");
  }
  const bool has_byte_order = header_.type.bytes > 1 && header_.encoding != NrrdEncoding::Text;
  if (has_byte_order && !seen_.contains("endian")) {
    return malformed("endian: is missing, and the items have more than one byte");
  }
  if (header_.byte_skip < 0 && header_.encoding != NrrdEncoding::Raw) {
    return malformed("byte skip: -1 goes with encoding raw only");
  }
  return header_;
}

Result<void> NrrdFields::read_type(std::string_view value) {
  const std::string name = plain(value);
  const auto* known = std::find_if(kTypes.begin(), kTypes.end(),
                                   [&](const TypeName& type) { return type.name == name; });
  if (known == kTypes.end()) {
    return unsupported("type: " + quoted(value) +
                       " is no integer of 8 to 64 bits, float or double");
  }
  header_.type.kind = known->kind;
  header_.type.bytes = known->bytes;
  return {};
}

Result<void> NrrdFields::read_dimension(std::string_view value) {
  std::uint32_t dimension = 0;
  const auto words = words_of(value);
  if (words.size() != 1 || !parse_number(words[0], dimension)) {
    return malformed("dimension: expected a whole number, found " + quoted(value));
  }
  if (dimension == 3) return {};
  return unsupported("dimension: is " + std::to_string(dimension) + ", expected 3");
}

Result<void> NrrdFields::read_sizes(std::string_view value) {
  // The format wants it so, and a wrong dimension explains more than a wrong count.
  if (!seen_.contains("dimension")) return malformed("sizes: come before dimension");
  const auto words = three_of("sizes", value);
  if (!words) return tl::unexpected(words.error());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string field = "sizes[" + std::to_string(axis) + "]";
    const std::string_view word = (*words)[axis];
    if (word.find_first_not_of("0123456789") != std::string_view::npos) {
      return malformed(field + ": expected a whole number, found " + quoted(word));
    }
    std::uint32_t count = 0;
    if (!parse_number(word, count) || count > VoxelGrid::kMaxCellsPerAxis) {
      return fail(Errc::TooLarge, field + ": " + std::string(word.substr(0, 24)) +
                                      " cells; the limit is " +
                                      std::to_string(VoxelGrid::kMaxCellsPerAxis));
    }
    if (count == 0) {
      return malformed(field + ": is 0; a world has at least 1 cell along each axis");
    }
    header_.sizes[axis] = count;
  }
  return {};
}

Result<void> NrrdFields::read_encoding(std::string_view value) {
  const std::string name = plain(value);
  if (name == "raw") {
    header_.encoding = NrrdEncoding::Raw;
  } else if (name == "gzip" || name == "gz") {
    header_.encoding = NrrdEncoding::Gzip;
  } else if (name == "text" || name == "txt" || name == "ascii") {
    header_.encoding = NrrdEncoding::Text;
  } else {
    return unsupported("encoding: " + quoted(value) + " is not raw, gzip, gz, text, txt or ascii");
  }
  return {};
}

Result<void> NrrdFields::read_endian(std::string_view value) {
  const std::string name = plain(value);
  header_.type.is_big_endian = name == "big";
  if (name == "big" || name == "little") return {};
  return malformed("endian: expected little or big, found " + quoted(value));
}

Result<void> NrrdFields::read_spacings(std::string_view value) {
  const auto words = three_of("spacings", value);
  if (!words) return tl::unexpected(words.error());
  std::array<double, 3> spacing{};
  std::size_t unknown = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string_view word = (*words)[axis];
    const bool is_number = parse_number(word, spacing[axis]);
    if (is_number && std::isnan(spacing[axis])) {
      ++unknown;
    } else if (!is_number || !std::isfinite(spacing[axis]) || !(spacing[axis] > 0)) {
      return malformed("spacings[" + std::to_string(axis) +
                       "]: expected a length greater than 0, found " + quoted(word));
    }
  }
  // NaN is the format's word for "not known".
  if (unknown == 3) return {};
  if (unknown > 0) return malformed("spacings: some are known and some are NaN");
  return set_spacing(spacing);
}

Result<void> NrrdFields::read_directions(std::string_view value) {
  std::array<double, 3> spacing{};
  std::string_view rest = value;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string field = "space directions[" + std::to_string(axis) + "]";
    rest.remove_prefix(std::min(rest.find_first_not_of(kBlanks), rest.size()));
    if (rest.starts_with("none")) return unsupported(field + ": is none; the axis is not in space");
    const auto end = rest.find(')');
    if (!rest.starts_with('(') || end == std::string_view::npos) {
      return malformed(field + ": expected (number,number,number), found " + quoted(rest));
    }
    const auto length = length_of_vector(rest.substr(1, end - 1), field);
    if (!length) return tl::unexpected(length.error());
    spacing[axis] = *length;
    rest.remove_prefix(end + 1);
  }
  if (!words_of(rest).empty()) return malformed("space directions: has more than 3 entries");
  return set_spacing(spacing);
}

Result<void> NrrdFields::set_spacing(const std::array<double, 3>& spacing) {
  if (header_.spacing) return malformed("spacings: space directions say them, too");
  header_.spacing = spacing;
  return {};
}

Result<void> NrrdFields::read_bounds(std::string_view /*value*/) {
  header_.has_axis_bounds = true;
  return {};
}

Result<void> NrrdFields::read_kinds(std::string_view value) {
  const auto words = three_of("kinds", value);
  if (!words) return tl::unexpected(words.error());
  for (const std::string_view word : *words) {
    const std::string kind = plain(word);
    if (kind == "domain" || kind == "space" || kind == "???" || kind == "none") continue;
    return unsupported("kinds: " + quoted(word) + " is no axis in space");
  }
  return {};
}

Result<void> NrrdFields::read_line_skip(std::string_view value) {
  const auto words = words_of(value);
  if (words.size() == 1 && parse_number(words[0], header_.line_skip) &&
      header_.line_skip <= kNrrdMaxLineSkip) {
    return {};
  }
  return malformed("line skip: expected a whole number from 0 to " +
                   std::to_string(kNrrdMaxLineSkip) + ", found " + quoted(value));
}

Result<void> NrrdFields::read_byte_skip(std::string_view value) {
  const auto words = words_of(value);
  if (words.size() == 1 && parse_number(words[0], header_.byte_skip) && header_.byte_skip >= -1 &&
      header_.byte_skip <= kNrrdMaxByteSkip) {
    return {};
  }
  return malformed("byte skip: expected a whole number from -1 to " +
                   std::to_string(kNrrdMaxByteSkip) + ", found " + quoted(value));
}

// A header comes from anywhere, the daemon may read what its sender may not: the file beside it,
// or in a folder below, and no other.
Result<void> NrrdFields::read_data_file(std::string_view value) {
  const bool is_printable = std::none_of(value.begin(), value.end(),
                                         [](char c) { return c == '\x7f' || (c >= 0 && c < ' '); });
  if (value.empty() || value.size() > 255 || !is_printable) {
    return malformed("data file: expected the name of a file, found " + quoted(value));
  }
  if (plain(value.substr(0, 4)) == "list" && (value.size() == 4 || value[4] == ' ')) {
    return unsupported("data file: is a LIST, expected one file");
  }
  if (value.find('%') != std::string_view::npos) {
    return unsupported("data file: is a pattern of names, expected one file");
  }
  bool leaves_folder = value.front() == '/';
  for (std::string_view rest = value; !rest.empty();) {
    const auto end = std::min(rest.find('/'), rest.size());
    leaves_folder = leaves_folder || rest.substr(0, end) == "..";
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  if (leaves_folder) {
    return unsupported("data file: " + quoted(value) + " is not in the folder of its header");
  }
  header_.data_file = std::string(value);
  return {};
}

Result<void> NrrdFields::ignore(std::string_view /*value*/) { return {}; }

}  // namespace thimble::world
