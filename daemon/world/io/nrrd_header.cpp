#include "daemon/world/io/nrrd_header.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "daemon/world/io/nrrd_fields.hpp"
#include "daemon/world/io/quoted.hpp"

namespace thimble::world {
namespace {

constexpr std::string_view kMagic = "NRRD000";

[[nodiscard]] tl::unexpected<Error> malformed(std::string message) {
  return fail(Errc::Malformed, std::move(message));
}

// Takes one line, without its end ("\n" or "\r\n"); false when `rest` holds no whole one.
[[nodiscard]] bool take_line(std::string_view& rest, bool is_all, std::string_view& line) {
  const auto end = rest.find('\n');
  if (end == std::string_view::npos && (!is_all || rest.empty())) return false;
  line = rest.substr(0, end);
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return true;
}

[[nodiscard]] Result<void> check_magic(std::string_view line) {
  if (!line.starts_with(kMagic)) return malformed("magic: not an NRRD file");
  const auto version = line.substr(kMagic.size());
  if (version.size() == 1 && version[0] >= '1' && version[0] <= '5') return {};
  return fail(Errc::Unsupported, "magic: version " + quoted(version) + " is not 1 to 5");
}

[[nodiscard]] Result<void> read_line(std::string_view line, NrrdFields& fields) {
  if (line.starts_with('#')) return {};
  const auto colon = line.find(':');
  // "key:=value" is for people; "field: description" is for us.
  if (colon != std::string_view::npos && line.substr(colon).starts_with(":=")) return {};
  if (colon == std::string_view::npos || (line.size() > colon + 1 && line[colon + 1] != ' ')) {
    return malformed("header: " + quoted(line) + " is neither a field, a key nor a comment");
  }
  std::string_view value = line.substr(colon + 1);
  value.remove_prefix(std::min(value.find_first_not_of(" \t"), value.size()));
  return fields.read(line.substr(0, colon), value.substr(0, value.find_last_not_of(" \t") + 1));
}

}  // namespace

Result<NrrdHeader> parse_nrrd_header(std::string_view text, bool is_all) {
  std::string_view rest = text.substr(0, kNrrdMaxHeaderBytes);
  is_all = is_all && rest.size() == text.size();
  std::string_view line;
  if (!take_line(rest, is_all, line)) return malformed("magic: not an NRRD file");
  if (const auto checked = check_magic(line); !checked) return tl::unexpected(checked.error());
  NrrdFields fields;
  bool is_ended = false;
  while (!is_ended && take_line(rest, is_all, line)) {
    is_ended = line.empty();
    if (is_ended) break;
    if (const auto read = read_line(line, fields); !read) return tl::unexpected(read.error());
  }
  auto header = fields.finish();
  if (!is_ended && !(is_all && rest.empty() && header && !header->data_file.empty())) {
    return malformed("header: no blank line ends it within " + std::to_string(kNrrdMaxHeaderBytes) +
                     " bytes");
  }
  if (header) header->header_bytes = text.substr(0, kNrrdMaxHeaderBytes).size() - rest.size();
  return header;
}

}  // namespace thimble::world
