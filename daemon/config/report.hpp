#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/config/load.hpp"

namespace thimble::config {

// Where something was written: a line of the file, or an override (`file` is "--set KEY").
struct Place {
  std::string file;
  int line{0};
  int column{0};
};

// Collects the mistakes of one configuration, and the keys that the schema asked for.
// Thread: one. Not RT.
class Report {
 public:
  // Names and values of a configuration are in there: all is escaped() on the way in.
  void add(const Place& place, std::string_view key, std::string_view message);
  void add_known_key(std::string schema_path) { known_keys_.insert(std::move(schema_path)); }

  [[nodiscard]] bool has_mistake(std::string_view key) const;
  [[nodiscard]] bool is_empty() const noexcept { return errors_.empty(); }
  // The mistakes by line, those of overrides last, at most kMaxErrors and one about the rest.
  [[nodiscard]] std::vector<ConfigError> take();
  [[nodiscard]] const std::set<std::string>& known_keys() const noexcept { return known_keys_; }

 private:
  std::vector<ConfigError> errors_;
  std::size_t left_out_{0};
  std::set<std::string> known_keys_;
};

// `text` with control characters as \x1b, and so what turns letters round: fit for a terminal and
// one line.
[[nodiscard]] std::string escaped(std::string_view text);
// `text` in quotes, shortened and escaped.
[[nodiscard]] std::string in_quotes(std::string_view text);
// A number as a person writes it: 0.5, 1000.
[[nodiscard]] std::string shown(double value);
// The one of `words` that `word` was probably meant to be, or empty.
[[nodiscard]] std::string_view nearest(std::string_view word,
                                       const std::vector<std::string>& words);

}  // namespace thimble::config
