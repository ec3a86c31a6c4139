#include "cli/flight/recording.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <optional>
#include <span>

namespace thimble::flight {
namespace {

constexpr std::string_view kTitle = "# Thimble flight recording, version 1";
// More than any version has; a line of commas costs no memory.
constexpr std::size_t kMaxColumns = 256;
constexpr std::array<std::string_view, 22> kNeeded{
    "tick",           "now_s",          "lateness_s",     "sample_age_s",
    "state",          "read",           "fault",          "velocity_x_m_per_s",
    "offset_x_m",     "offset_y_m",     "offset_z_m",     "velocity_y_m_per_s",
    "wish_x_newton",  "wish_y_newton",  "wish_z_newton",  "velocity_z_m_per_s",
    "force_x_newton", "force_y_newton", "force_z_newton", "in_contact",
    "limited",        "stale"};

// Cuts `text` up to `end` off its front; all of it when there is no `end`.
std::string_view take_until(std::string_view& text, char end) {
  const std::size_t at = text.find(end);
  const std::string_view out = text.substr(0, at);
  text.remove_prefix(at == std::string_view::npos ? text.size() : at + 1);
  return out;
}

tl::unexpected<Error> malformed(std::size_t line, const std::string& expected) {
  return fail(Errc::Malformed, "line " + std::to_string(line) + ": expected " + expected);
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> cells;
  while (cells.size() <= kMaxColumns) {
    const bool is_last = line.find(',') == std::string_view::npos;
    cells.push_back(take_until(line, ','));
    if (is_last) break;
  }
  return cells;
}

// The place of each needed column in a row.
using Columns = std::array<std::size_t, kNeeded.size()>;

std::optional<Columns> find_columns(const std::vector<std::string_view>& names,
                                    std::string& missing) {
  Columns columns{};
  for (std::size_t i = 0; i < kNeeded.size(); ++i) {
    const auto found = std::find(names.begin(), names.end(), kNeeded[i]);
    if (found == names.end()) {
      missing = std::string(kNeeded[i]);
      return std::nullopt;
    }
    columns[i] = static_cast<std::size_t>(found - names.begin());
  }
  return columns;
}

// The cells of one row by the name of their column; the first that is not what it should be.
class Row {
 public:
  Row(const Columns& columns, std::span<const std::string_view> cells)
      : columns_(columns), cells_(cells) {}

  [[nodiscard]] std::string_view text(std::string_view name) const {
    const auto found = std::find(kNeeded.begin(), kNeeded.end(), name);
    return cells_[columns_[static_cast<std::size_t>(found - kNeeded.begin())]];
  }
  double number(std::string_view name) { return parsed<double>(name); }
  std::uint64_t count(std::string_view name) { return parsed<std::uint64_t>(name); }
  bool flag(std::string_view name) { return parsed<unsigned>(name) != 0; }
  template <class Vector>
  Vector vector(const std::string& what, const std::string& unit) {
    return {number(what + "_x_" + unit), number(what + "_y_" + unit), number(what + "_z_" + unit)};
  }
  [[nodiscard]] const std::string& wrong() const { return wrong_; }

 private:
  template <class Number>
  Number parsed(std::string_view name) {
    const std::string_view cell = text(name);
    Number value{};
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error == std::errc{} && end == cell.data() + cell.size()) return value;
    if (wrong_.empty()) wrong_ = std::string(name);
    return {};
  }

  const Columns& columns_;
  std::span<const std::string_view> cells_;
  std::string wrong_;
};

Sample sample_of(Row& row) {
  Sample sample;
  sample.tick = row.count("tick");
  sample.now_s = row.number("now_s");
  sample.lateness_s = row.number("lateness_s");
  sample.sample_age_s = row.number("sample_age_s");
  sample.state = row.text("state");
  sample.read = row.text("read");
  sample.fault = row.text("fault");
  sample.velocity = row.vector<Velocity3>("velocity", "m_per_s");
  sample.offset = row.vector<Displacement3>("offset", "m");
  sample.wish = row.vector<Force3>("wish", "newton");
  sample.force = row.vector<Force3>("force", "newton");
  sample.is_in_contact = row.flag("in_contact");
  sample.is_limited = row.flag("limited");
  sample.is_stale = row.flag("stale");
  return sample;
}

void take_comment(std::string_view line, Recording& out) {
  for (const auto& [key, value] : {std::pair{std::string_view("# arm: "), &out.arm},
                                   {"# device: ", &out.device},
                                   {"# cause: ", &out.cause},
                                   {"# meaning: ", &out.meaning}}) {
    if (line.starts_with(key)) *value = line.substr(key.size());
  }
}

}  // namespace

Result<Recording> parse_recording(std::string_view text) {
  if (text.size() > kMaxFileBytes) {
    return fail(Errc::TooLarge, "more than " + std::to_string(kMaxFileBytes) + " bytes");
  }
  Recording out;
  std::optional<Columns> columns;
  std::size_t width = 0;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view line = take_until(text, '\n');
    if (number == 1 && line != kTitle) return malformed(1, "\"" + std::string(kTitle) + "\"");
    if (line.starts_with('#')) {
      take_comment(line, out);
      continue;
    }
    const std::vector<std::string_view> cells = split(line);
    if (!columns) {
      std::string missing;
      columns = find_columns(cells, missing);
      width = cells.size();
      if (width > kMaxColumns) return malformed(number, "fewer columns");
      if (!columns) return malformed(number, "a column " + missing);
      continue;
    }
    if (cells.size() != width) return malformed(number, std::to_string(width) + " columns");
    Row row(*columns, cells);
    Sample sample = sample_of(row);
    if (!row.wrong().empty()) return malformed(number, "a number for " + row.wrong());
    out.samples.push_back(std::move(sample));
  }
  if (out.samples.empty()) return fail(Errc::Malformed, "holds no ticks");
  return out;
}

}  // namespace thimble::flight
