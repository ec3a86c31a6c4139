// NOLINTNEXTLINE(readability-identifier-naming): toml++'s own name
#define TOML_IMPLEMENTATION
#include "daemon/config/tree.hpp"

#include <algorithm>
#include <charconv>
#include <utility>
#include <vector>

#include "daemon/config/load.hpp"

namespace thimble::config {
namespace {

constexpr std::string_view kOverride = "--set ";
constexpr std::size_t kMaxKeyBytes = 256;

Place place_of_override(std::string_view key) {
  return {std::string(kOverride) + std::string(key), 0, 0};
}

// The first line, from 1, with more dots than a key may have; 0 when there is none. What is
// inside strings and comments counts too: only the parser could tell, and it is not total here.
int crowded_line(std::string_view text) {
  int line = 1;
  std::size_t dots = 0;
  for (const char c : text) {
    if (c == '\n') {
      ++line;
      dots = 0;
    }
    if (c == '.' && ++dots > kMaxDotsInLine) return line;
  }
  return 0;
}

std::string too_many_dots() {
  return "expected at most " + std::to_string(kMaxDotsInLine) + " dots in a line, found more";
}

std::vector<std::string> split(std::string_view key) {
  std::vector<std::string> parts;
  for (;;) {
    const std::size_t dot = key.find('.');
    parts.emplace_back(key.substr(0, dot));
    if (dot == std::string_view::npos) return parts;
    key.remove_prefix(dot + 1);
  }
}

std::string as_toml_string(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7F) {
      out += "\\u00";
      out += kDigits[byte >> 4U];
      out += kDigits[byte & 0xFU];
      continue;
    }
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out += '"';
}

// One override on its way down the tree: `key` as the person wrote it, for messages.
struct Override {
  std::string key;
  std::vector<std::string> parts;
  toml::table document;  // {v = VALUE}
  Report& report;

  void reject(std::string_view message) const { report.add(place_of_override(key), "", message); }
  [[nodiscard]] std::string source() const { return std::string(kOverride) + key; }
  // An empty table that knows where it was made.
  [[nodiscard]] toml::table new_table() const {
    auto made = toml::parse("v = {}", source());
    return std::move(*made.table()["v"].as_table());
  }
};

// `text` as the right side of one TOML assignment, else as a string; nothing for bytes that
// are neither.
std::optional<toml::table> parse_value(std::string_view text, const std::string& source) {
  auto as_is = toml::parse("v = " + std::string(text), source);
  // A line break in the value must not smuggle in another key.
  if (as_is && as_is.table().size() == 1) return std::move(as_is).table();
  auto as_string = toml::parse("v = " + as_toml_string(text), source);
  if (!as_string) return std::nullopt;
  return std::move(as_string).table();
}

// The table in `parent` called `part`, made when missing; nothing when something else is there.
toml::table* descend(toml::table& parent, const std::string& part, const Override& change) {
  toml::node* child = parent.get(part);
  if (child == nullptr) {
    parent.insert(part, change.new_table());
    child = parent.get(part);
  }
  if (!child->is_table()) change.reject(in_quotes(part) + " is not a table");
  return child->as_table();
}

std::string names_of(const toml::array& elements) {
  std::string names;
  for (const toml::node& element : elements) {
    const toml::table* table = element.as_table();
    const auto name = table == nullptr ? std::nullopt : (*table)["name"].value<std::string_view>();
    if (name) names += (names.empty() ? "" : ", ") + in_quotes(*name);
  }
  return names;
}

toml::table* element_at(toml::array& elements, std::size_t index, const Override& change) {
  if (index == elements.size()) elements.push_back(change.new_table());
  if (index >= elements.size()) {
    change.reject("there is no element " + std::to_string(index) + ", only " +
                  std::to_string(elements.size()));
    return nullptr;
  }
  if (!elements[index].is_table()) change.reject("this element is not a table");
  return elements[index].as_table();
}

// Whether parts[1] is a key of such an element, such as the "limits" of an arm.
bool is_key_of_element(const Override& change) {
  const std::string key = change.parts[0] + "." + change.parts[1];
  const std::vector<std::string> keys = schema_keys();
  return std::any_of(keys.begin(), keys.end(), [&](const std::string& known) {
    return known == key || known.starts_with(key + ".");
  });
}

// Which element of [[arm]] or [[world]] is meant by parts[1], and how many parts that took.
std::pair<toml::table*, std::size_t> find_element(toml::array& elements, const Override& change) {
  const std::string& part = change.parts[1];
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), index);
  if (error == std::errc{} && end == part.data() + part.size()) {
    return {element_at(elements, index, change), 2};
  }
  for (toml::node& element : elements) {
    toml::table* table = element.as_table();
    const bool has_more = change.parts.size() > 2;
    if (has_more && table != nullptr && (*table)["name"].value<std::string_view>() == part) {
      return {table, 2};
    }
  }
  const std::string names = names_of(elements);
  // Else a table of that name would be made in the one that there is, and the file blamed for it.
  if (change.parts.size() > 2 && !names.empty() && !is_key_of_element(change)) {
    change.reject("there is no " + change.parts[0] + " " + in_quotes(part) +
                  "; expected an index or one of " + names);
    return {nullptr, 0};
  }
  if (elements.size() == 1) return {element_at(elements, 0, change), 1};
  change.reject("nothing is called " + in_quotes(part) +
                (names.empty() ? ", and there is not exactly one to be meant"
                               : "; expected an index or one of " + names));
  return {nullptr, 0};
}

std::pair<toml::table*, std::size_t> enter_array(toml::table& root, const Override& change) {
  const std::string& name = change.parts[0];
  if (root.get(name) == nullptr) root.insert(name, toml::array{});
  toml::array* elements = root[name].as_array();
  if (elements == nullptr) {
    change.reject("[" + name + "] is not an array of tables; write [[" + name + "]]");
    return {nullptr, 0};
  }
  return find_element(*elements, change);
}

void assign(toml::table& root, Override change) {
  toml::table* table = &root;
  std::size_t next = 0;
  const bool is_in_array = change.parts[0] == "arm" || change.parts[0] == "world";
  if (is_in_array && change.parts.size() > 1) {
    std::tie(table, next) = enter_array(root, change);
  }
  for (; table != nullptr && next + 1 < change.parts.size(); ++next) {
    table = descend(*table, change.parts[next], change);
  }
  if (table == nullptr) return;
  if (next >= change.parts.size())
    return change.reject("expected a key of this element, found none");
  // Erased first: an assignment would keep the place of the old value.
  const std::string& last = change.parts[next];
  table->erase(last);
  change.document["v"].node()->visit([&](auto& value) {
    table->insert(toml::key(last, change.document.begin()->first.source()), std::move(value));
  });
}

}  // namespace

Place place_of(const toml::source_region& region, const Place& otherwise) {
  if (region.begin.line == 0) return otherwise;
  Place place{region.path ? *region.path : otherwise.file, 0, 0};
  if (place.file.starts_with(kOverride)) return place;
  place.line = static_cast<int>(region.begin.line);
  place.column = static_cast<int>(region.begin.column);
  return place;
}

std::optional<toml::table> parse_tree(std::string_view text, const std::string& file,
                                      Report& report) {
  if (const int line = crowded_line(text); line != 0) {
    report.add({file, line, 0}, "", too_many_dots());
    return std::nullopt;
  }
  auto result = toml::parse(text, file);
  if (result) return std::move(result).table();
  const toml::parse_error& error = result.error();
  report.add(place_of(error.source(), {file, 0, 0}), "",
             "expected TOML in UTF-8; " + std::string(error.description()));
  return std::nullopt;
}

void apply_override(toml::table& root, std::string_view changetext, Report& report) {
  const std::size_t equals = changetext.find('=');
  const std::string_view key = changetext.substr(0, equals);
  const Place place = place_of_override(key.size() > kMaxKeyBytes ? "KEY" : key);
  if (equals == std::string_view::npos) {
    return report.add(place, "", "expected KEY=VALUE, found no \"=\"");
  }
  if (key.size() > kMaxKeyBytes) return report.add(place, "", "expected a shorter key");
  auto parts = split(key);
  for (const std::string& part : parts) {
    if (part.empty()) return report.add(place, "", "expected names between dots, found none");
  }
  if (crowded_line(changetext) != 0) return report.add(place, "", too_many_dots());
  auto document = parse_value(changetext.substr(equals + 1), place.file);
  if (!document) return report.add(place, "", "expected a value in UTF-8");
  assign(root, {std::string(key), std::move(parts), std::move(*document), report});
}

}  // namespace thimble::config
