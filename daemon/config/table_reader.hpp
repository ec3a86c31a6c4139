#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/config/report.hpp"
#include "daemon/config/toml.hpp"

namespace thimble::config {

inline constexpr double kNoMax = std::numeric_limits<double>::max();

// Numbers that a key may have, ends included unless said otherwise.
struct Range {
  double min{0};
  double max{0};
  bool is_min_open{false};
};

template <class Enum>
struct Choice {
  std::string_view word;
  Enum value;
};

// Reads one table of the tree key by key, complaining about types and ranges, and knows in the
// end which keys nobody asked for. A read that fails leaves its output untouched.
//
// Thread: one. Not RT. Ownership: the tree and the report must outlive it.
class TableReader {
 public:
  // `table` may be null: a table that is not there, without keys. `path` is for messages,
  // `schema_path` the same without indices.
  TableReader(const toml::table* table, std::string path, std::string schema_path, Place place,
              Report& report);

  [[nodiscard]] bool is_present() const noexcept { return table_ != nullptr; }
  [[nodiscard]] bool has(std::string_view key) const;
  [[nodiscard]] bool has_text(std::string_view key) const;

  // True when the key is there and good.
  bool read(std::string_view key, std::string& out);
  bool read(std::string_view key, bool& out);
  bool read(std::string_view key, Range range, double& out);
  bool read_integer(std::string_view key, Range range, std::int64_t& out);
  template <class Enum>
  bool read(std::string_view key, std::span<const Choice<Enum>> choices, Enum& out);

  bool read(std::string_view key, std::optional<std::string>& out);
  bool read(std::string_view key, Range range, std::optional<double>& out);

  // An array of at most so many strings, none of them empty.
  bool read(std::string_view key, std::size_t max_count, std::vector<std::string>& out);
  // An array of just so many numbers.
  bool read(std::string_view key, Range range, std::optional<std::array<double, 3>>& out);

  [[nodiscard]] TableReader table(std::string_view key);
  [[nodiscard]] std::vector<TableReader> tables(std::string_view key);

  // Complains when a key is missing.
  void require(std::string_view key, std::string_view what);
  // Complains about the value of `key`, or about the table where the key is missing or empty.
  void reject(std::string_view key, std::string_view message);
  // The same, unless there is a complaint about the key already.
  void object(std::string_view key, std::string_view message);
  // Complains about every key that was not asked for.
  void finish();

  // True when the value was written by "--set".
  [[nodiscard]] bool is_override(std::string_view key) const;

 private:
  const toml::node* find(std::string_view key);
  // False for the message's sake: `return mismatch(…)`.
  bool mismatch(std::string_view key, const std::string& expected, const toml::node& found);
  // Complains about `node`, which the key or an element of its array has, unless it is good.
  bool read_string(std::string_view key, const toml::node& node, std::string& out);
  bool read_choice(std::string_view key, const std::vector<std::string>& words, std::size_t& index);
  [[nodiscard]] std::string path_of(std::string_view key) const;

  const toml::table* table_;
  std::string path_;
  std::string schema_path_;
  Place place_;
  std::reference_wrapper<Report> report_;
  std::vector<std::string> known_keys_;
};

template <class Enum>
bool TableReader::read(std::string_view key, std::span<const Choice<Enum>> choices, Enum& out) {
  std::vector<std::string> words;
  for (const auto& choice : choices) words.emplace_back(choice.word);
  std::size_t index = 0;
  if (!read_choice(key, words, index)) return false;
  out = choices[index].value;
  return true;
}

}  // namespace thimble::config
