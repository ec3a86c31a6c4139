#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/config/config.hpp"
#include "hal/base/result.hpp"

namespace thimble::config {

// A configuration is written by hand; a file beyond this is something else.
inline constexpr std::size_t kMaxFileBytes = std::size_t{1} << 16;
// Each dot of a key is a table within a table, which are destroyed recursively.
inline constexpr std::size_t kMaxDotsInLine = 256;
// Of one daemon: ours. The units have room for so many (decision 0511).
inline constexpr std::size_t kMaxArms = 32;
// Of one call; a last one says how many were left out.
inline constexpr std::size_t kMaxErrors = 100;

// One mistake of a configuration, in words for a person.
struct ConfigError {
  std::string file;     // as given to load(), or "--set KEY" when an override is to blame
  int line{0};          // from 1; 0: the file as a whole, or an override
  int column{0};        // from 1; 0 likewise
  std::string key;      // dotted, e.g. "arm.0.limits.force_newton"; empty for the whole file
  std::string message;  // what was expected, what was found
  bool operator==(const ConfigError&) const = default;
};

// "FILE:LINE:COLUMN: KEY: MESSAGE", without the parts that are not known; one line.
[[nodiscard]] std::string to_string(const ConfigError& error);

using ConfigResult = tl::expected<Config, std::vector<ConfigError>>;

// What is wrong with a value although the schema likes it.
struct Objection {
  enum class Table : std::uint8_t { Daemon, Arm, World };
  Table table{};
  std::size_t index{0};  // of arms and worlds
  std::string key;       // of the table; empty: the table itself
  std::string message;   // what was expected, what was found
};

// Judges what needs more than the file to be known: devices, models, volumes. It sees values that
// the schema refused as their defaults or empty, and has nothing to object to those; an objection
// to a key that already has a mistake is left out.
using Inspector = std::function<std::vector<Objection>(const Config&)>;

// Reads, overrides and checks a configuration, and reports every mistake of it at once (but
// only the first of TOML's own syntax). Overrides are "KEY=VALUE" with a dotted key, where an
// arm or a world goes by its index or its name, or without either when there is one. VALUE is
// TOML, else a string. Relative paths of the file are joined with the folder it lies in; those
// of an override are left to the working directory.
//
// Thread: any. Not RT. Errors: never throws but bad_alloc; the list is never empty.
[[nodiscard]] ConfigResult load(const std::filesystem::path& file,
                                std::span<const std::string> overrides = {},
                                const Inspector& inspect = {});
// The bytes of such a file, for parse(); longer ones are cut behind what that refuses. Waits for
// nobody: only a regular file is read. Errors: one mistake.
[[nodiscard]] tl::expected<std::string, std::vector<ConfigError>> read_text(
    const std::filesystem::path& file);
// The same as load() for a text that is already in memory; total: any bytes give a value or errors.
[[nodiscard]] ConfigResult parse(std::string_view text, const std::filesystem::path& file,
                                 std::span<const std::string> overrides = {},
                                 const Inspector& inspect = {});

// Every key there is, dotted, without indices: "arm.limits.ramp_s". Sorted.
[[nodiscard]] std::vector<std::string> schema_keys();

}  // namespace thimble::config
