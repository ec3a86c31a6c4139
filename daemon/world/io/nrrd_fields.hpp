#pragma once

#include <array>
#include <set>
#include <string>
#include <string_view>

#include "daemon/world/io/nrrd_header.hpp"
#include "hal/base/result.hpp"

namespace thimble::world {

// Collects the fields of one NRRD header, line by line, and judges them together in the end.
//
// Thread: one. Not RT. Errors: as parse_nrrd_header().
class NrrdFields {
 public:
  // `name` and `value` as they stand on both sides of the colon, but for the value's outer blanks.
  [[nodiscard]] Result<void> read(std::string_view name, std::string_view value);
  [[nodiscard]] Result<NrrdHeader> finish() const;

 private:
  struct Reader;
  [[nodiscard]] Result<void> read_type(std::string_view value);
  [[nodiscard]] Result<void> read_dimension(std::string_view value);
  [[nodiscard]] Result<void> read_sizes(std::string_view value);
  [[nodiscard]] Result<void> read_encoding(std::string_view value);
  [[nodiscard]] Result<void> read_endian(std::string_view value);
  [[nodiscard]] Result<void> read_spacings(std::string_view value);
  [[nodiscard]] Result<void> read_directions(std::string_view value);
  [[nodiscard]] Result<void> set_spacing(const std::array<double, 3>& spacing);
  [[nodiscard]] Result<void> read_bounds(std::string_view value);
  [[nodiscard]] Result<void> read_kinds(std::string_view value);
  [[nodiscard]] Result<void> read_line_skip(std::string_view value);
  [[nodiscard]] Result<void> read_byte_skip(std::string_view value);
  [[nodiscard]] Result<void> read_data_file(std::string_view value);
  [[nodiscard]] Result<void> ignore(std::string_view value);

  NrrdHeader header_{};
  std::set<std::string> seen_{};
};

}  // namespace thimble::world
