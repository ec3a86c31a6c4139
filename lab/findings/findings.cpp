#include "lab/findings/findings.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>

namespace thimble::lab {
namespace {

std::string shown(const Cell& cell, int decimals) {
  if (const std::string* text = std::get_if<std::string>(&cell)) return *text;
  const double number = std::get<double>(cell);
  if (!std::isfinite(number)) return "-";
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "%.*f", decimals, number);
  return buffer;
}

std::string heading(const Column& column) {
  return column.unit.empty() ? column.name : column.name + " [" + column.unit + "]";
}

// Numbers to the right, words to the left.
void append_padded(std::string& line, const std::string& text, std::size_t width, bool is_number) {
  const std::string gap(width - std::min(width, text.size()), ' ');
  line += is_number ? gap + text : text + gap;
  line += "  ";
}

void end_line(std::string& text, std::string line) {
  while (!line.empty() && line.back() == ' ') line.pop_back();
  text += line + '\n';
}

std::string tell_table(const Table& table) {
  std::vector<std::size_t> widths;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    std::size_t width = heading(table.columns[i]).size();
    for (const auto& row : table.rows) {
      width = std::max(width, shown(row[i], table.columns[i].decimals).size());
    }
    widths.push_back(width);
  }
  const auto is_number = [&](std::size_t column) {
    return !table.rows.empty() && std::holds_alternative<double>(table.rows.front()[column]);
  };
  std::string text = table.title + '\n';
  std::string line;
  for (std::size_t i = 0; i < widths.size(); ++i) {
    append_padded(line, heading(table.columns[i]), widths[i], is_number(i));
  }
  end_line(text, line);
  for (const auto& row : table.rows) {
    line.clear();
    for (std::size_t i = 0; i < widths.size(); ++i) {
      append_padded(line, shown(row[i], table.columns[i].decimals), widths[i], is_number(i));
    }
    end_line(text, line);
  }
  return text;
}

}  // namespace

bool Findings::is_met() const noexcept {
  return std::all_of(criteria.begin(), criteria.end(), [](const Criterion& c) { return c.is_met; });
}

std::string tell(const Findings& findings) {
  std::string text = findings.title + "\n\n";
  for (const Table& table : findings.tables) {
    if (!table.is_for_files) text += tell_table(table) + '\n';
  }
  for (const std::string& remark : findings.remarks) text += remark + '\n';
  for (const Criterion& criterion : findings.criteria) {
    text += (criterion.is_met ? "as it must be: " : "NOT as it must be: ") + criterion.text + '\n';
  }
  return text;
}

}  // namespace thimble::lab
