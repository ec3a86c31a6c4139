#include "daemon/config/table_reader.hpp"

#include <algorithm>
#include <cmath>

#include "daemon/config/tree.hpp"

namespace thimble::config {
namespace {

std::string describe(const toml::node& node) {
  if (const auto* text = node.as_string()) return in_quotes(text->get());
  if (const auto* value = node.as_integer()) return std::to_string(value->get());
  if (const auto* value = node.as_floating_point()) return shown(value->get());
  if (const auto* value = node.as_boolean()) return value->get() ? "true" : "false";
  if (node.is_array_of_tables()) return "an array of tables";
  if (node.is_array()) return "an array";
  if (node.is_table()) return "a table";
  return "a date or time";
}

std::optional<double> number_in(const toml::node& node) {
  if (const auto* value = node.as_integer()) return static_cast<double>(value->get());
  if (const auto* value = node.as_floating_point()) return value->get();
  return std::nullopt;
}

bool is_within(double value, Range range) {
  return (range.is_min_open ? value > range.min : value >= range.min) && value <= range.max;
}

std::string describe(Range range) {
  if (range.is_min_open && range.max == kNoMax) return "above " + shown(range.min);
  if (range.is_min_open) return "above " + shown(range.min) + " up to " + shown(range.max);
  return "from " + shown(range.min) + " to " + shown(range.max);
}

// Keys that TOML needs quotes for are shown in quotes, so that no byte of them reaches a
// terminal raw.
std::string shown_key(std::string_view key) {
  const bool is_bare = !key.empty() && std::all_of(key.begin(), key.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  });
  return is_bare && key.size() <= 60 ? std::string(key) : in_quotes(key);
}

}  // namespace

TableReader::TableReader(const toml::table* table, std::string path, std::string schema_path,
                         Place place, Report& report)
    : table_(table),
      path_(std::move(path)),
      schema_path_(std::move(schema_path)),
      place_(std::move(place)),
      report_(report) {}

bool TableReader::has(std::string_view key) const {
  return table_ != nullptr && table_->contains(key);
}

bool TableReader::has_text(std::string_view key) const {
  return has(key) && table_->get(key)->is_string();
}

const toml::node* TableReader::find(std::string_view key) {
  if (std::find(known_keys_.begin(), known_keys_.end(), key) == known_keys_.end()) {
    known_keys_.emplace_back(key);
    report_.get().add_known_key(schema_path_.empty() ? std::string(key)
                                                     : schema_path_ + "." + std::string(key));
  }
  return table_ == nullptr ? nullptr : table_->get(key);
}

bool TableReader::mismatch(std::string_view key, const std::string& expected,
                           const toml::node& found) {
  reject(key, "expected " + expected + ", found " + describe(found));
  return false;
}

bool TableReader::read(std::string_view key, std::string& out) {
  const toml::node* node = find(key);
  return node != nullptr && read_string(key, *node, out);
}

bool TableReader::read_string(std::string_view key, const toml::node& node, std::string& out) {
  const auto* text = node.as_string();
  if (text == nullptr) return mismatch(key, "a string", node);
  if (text->get().empty()) return mismatch(key, "a string that is not empty", node);
  // Names and paths go to system calls, which would stop at the zero byte.
  if (text->get().find('\0') != std::string::npos) {
    return mismatch(key, "a string without zero bytes", node);
  }
  out = text->get();
  return true;
}

bool TableReader::read(std::string_view key, bool& out) {
  const toml::node* node = find(key);
  if (node == nullptr) return false;
  const auto* value = node->as_boolean();
  if (value == nullptr) return mismatch(key, "true or false", *node);
  out = value->get();
  return true;
}

bool TableReader::read(std::string_view key, Range range, double& out) {
  const toml::node* node = find(key);
  if (node == nullptr) return false;
  const std::string expected = "a number " + describe(range);
  const std::optional<double> value = number_in(*node);
  // NaN is within no range, infinity beyond every one.
  if (!value || !is_within(*value, range)) return mismatch(key, expected, *node);
  out = *value;
  return true;
}

bool TableReader::read_integer(std::string_view key, Range range, std::int64_t& out) {
  const toml::node* node = find(key);
  if (node == nullptr) return false;
  const std::string expected = "a whole number " + describe(range);
  if (!node->is_integer()) return mismatch(key, expected, *node);
  const std::int64_t value = node->as_integer()->get();
  if (!is_within(static_cast<double>(value), range)) return mismatch(key, expected, *node);
  out = value;
  return true;
}

bool TableReader::read_choice(std::string_view key, const std::vector<std::string>& words,
                              std::size_t& index) {
  const toml::node* node = find(key);
  if (node == nullptr) return false;
  std::string expected;
  for (const std::string& word : words)
    expected += (expected.empty() ? "" : ", ") + in_quotes(word);
  if (words.size() > 1) expected.insert(0, "one of ");
  const auto* text = node->as_string();
  if (text == nullptr) return mismatch(key, expected, *node);
  const auto found = std::find(words.begin(), words.end(), text->get());
  if (found == words.end()) return mismatch(key, expected, *node);
  index = static_cast<std::size_t>(found - words.begin());
  return true;
}

bool TableReader::read(std::string_view key, std::optional<std::string>& out) {
  std::string value;
  if (!read(key, value)) return false;
  out = std::move(value);
  return true;
}

bool TableReader::read(std::string_view key, Range range, std::optional<double>& out) {
  double value = 0;
  if (!read(key, range, value)) return false;
  out = value;
  return true;
}

bool TableReader::read(std::string_view key, Range range,
                       std::optional<std::array<double, 3>>& out) {
  const toml::node* node = find(key);
  if (node == nullptr) return false;
  const std::string expected = "3 numbers, each " + describe(range);
  const toml::array* elements = node->as_array();
  if (elements == nullptr || elements->size() != 3) return mismatch(key, expected, *node);
  std::array<double, 3> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::optional<double> number = number_in(*elements->get(i));
    if (!number || !is_within(*number, range)) return mismatch(key, expected, *elements->get(i));
    numbers[i] = *number;
  }
  out = numbers;
  return true;
}

bool TableReader::read(std::string_view key, std::size_t max_count, std::vector<std::string>& out) {
  const toml::node* node = find(key);
  if (node == nullptr) return false;
  const std::string expected = "an array of at most " + std::to_string(max_count) + " strings";
  const toml::array* elements = node->as_array();
  if (elements == nullptr || elements->size() > max_count) return mismatch(key, expected, *node);
  std::vector<std::string> texts(elements->size());
  for (std::size_t i = 0; i < texts.size(); ++i) {
    if (!read_string(key, *elements->get(i), texts[i])) return false;
  }
  out = std::move(texts);
  return true;
}

TableReader TableReader::table(std::string_view key) {
  const toml::node* node = find(key);
  const std::string schema_path =
      schema_path_.empty() ? std::string(key) : schema_path_ + "." + std::string(key);
  const toml::table* child = node == nullptr ? nullptr : node->as_table();
  if (node != nullptr && child == nullptr) mismatch(key, "a table", *node);
  const Place place = node == nullptr ? place_ : place_of(node->source(), place_);
  return {child, path_of(key), schema_path, place, report_};
}

std::vector<TableReader> TableReader::tables(std::string_view key) {
  std::vector<TableReader> out;
  const toml::node* node = find(key);
  if (node == nullptr) return out;
  const toml::array* elements = node->as_array();
  const std::string schema_path =
      schema_path_.empty() ? std::string(key) : schema_path_ + "." + std::string(key);
  const std::string expected = "tables, each under [[" + schema_path + "]]";
  if (elements == nullptr) {
    mismatch(key, expected, *node);
    return out;
  }
  for (std::size_t i = 0; i < elements->size(); ++i) {
    const toml::node& element = (*elements)[i];
    const Place place = place_of(element.source(), place_);
    const std::string path = path_of(key) + "." + std::to_string(i);
    if (!element.is_table()) {
      report_.get().add(place, path, "expected " + expected + ", found " + describe(element));
      continue;
    }
    out.emplace_back(element.as_table(), path, schema_path, place, report_);
  }
  return out;
}

void TableReader::require(std::string_view key, std::string_view what) {
  if (has(key)) return;
  reject(key, "expected " + std::string(what) + ", found no such key");
}

void TableReader::reject(std::string_view key, std::string_view message) {
  const toml::node* node = table_ == nullptr ? nullptr : table_->get(key);
  const Place place = node == nullptr ? place_ : place_of(node->source(), place_);
  report_.get().add(place, path_of(key), message);
}

void TableReader::object(std::string_view key, std::string_view message) {
  if (!report_.get().has_mistake(path_of(key))) reject(key, message);
}

void TableReader::finish() {
  if (table_ == nullptr) return;
  for (const auto& [key, node] : *table_) {
    if (std::find(known_keys_.begin(), known_keys_.end(), key.str()) != known_keys_.end()) {
      continue;
    }
    const std::string_view meant = nearest(key.str(), known_keys_);
    report_.get().add(place_of(key.source(), place_), path_of(key.str()),
                      meant.empty()
                          ? "there is no such key"
                          : "there is no such key; did you mean " + in_quotes(meant) + "?");
  }
}

bool TableReader::is_override(std::string_view key) const {
  const toml::node* node = table_ == nullptr ? nullptr : table_->get(key);
  return node != nullptr && place_of(node->source(), place_).file.starts_with("--set ");
}

std::string TableReader::path_of(std::string_view key) const {
  if (key.empty()) return path_;
  return path_.empty() ? shown_key(key) : path_ + "." + shown_key(key);
}

}  // namespace thimble::config
