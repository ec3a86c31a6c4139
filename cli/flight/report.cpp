#include "cli/flight/report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

namespace thimble::flight {
namespace {

using cli::fit;
using cli::fixed;
using cli::Glyphs;
using cli::plain;

constexpr std::size_t kColumns = 80;
constexpr std::size_t kPlotColumns = 64;
constexpr std::size_t kPlotRows = 6;

bool has_fault(const Sample& sample) { return !sample.fault.empty() && sample.fault != "none"; }

// The first tick with the fault; the last one when none has it.
std::size_t stop_of(const Recording& recording) {
  const auto found = std::find_if(recording.samples.begin(), recording.samples.end(), has_fault);
  const auto at = static_cast<std::size_t>(found - recording.samples.begin());
  return std::min(at, recording.samples.size() - 1);
}

std::string right(const std::string& text, std::size_t width) {
  return text.size() >= width ? text.substr(0, width)
                              : std::string(width - text.size(), ' ') + text;
}

// NaN counts as the largest: it is what one looks for.
bool is_worse(double a, double b) { return std::isnan(a) || (!std::isnan(b) && a > b); }

// One bar a column, each the worst of its share of the ticks.
struct Curve {
  std::string_view title;
  std::string_view unit;
  int decimals;
  double (*value)(const Sample&);
};

std::vector<double> worst_by_column(const Recording& recording, const Curve& curve) {
  const std::size_t count = recording.samples.size();
  const std::size_t columns = std::min(kPlotColumns, count);
  std::vector<double> out(columns, 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    double& column = out[i * columns / count];
    const double value = curve.value(recording.samples[i]);
    if (is_worse(value, column)) column = value;
  }
  return out;
}

std::string plot(const Recording& recording, const Curve& curve, Glyphs glyphs) {
  const std::vector<double> columns = worst_by_column(recording, curve);
  double top = 0;
  for (const double value : columns) {
    if (std::isfinite(value)) top = std::max(top, value);
  }
  const char* const full = glyphs == Glyphs::Unicode ? "█" : "#";
  std::string out = std::string(curve.title) + ", " + std::string(curve.unit) + "\n";
  for (std::size_t row = kPlotRows; row-- > 0;) {
    const bool is_labelled = row + 1 == kPlotRows || row == 0;
    const double edge = top * static_cast<double>(row) / static_cast<double>(kPlotRows);
    const double label = row == 0 ? 0 : top;
    out += right(is_labelled ? fixed(label, curve.decimals) : "", 9) + " ";
    for (const double value : columns) {
      const bool is_reached = !std::isfinite(value) || (value > edge && value > 0);
      out += !is_reached ? " " : std::isfinite(value) ? full : "?";
    }
    out += '\n';
  }
  return out;
}

std::string flags_of(const Sample& sample) {
  std::string flags = has_fault(sample) ? sample.fault + " " : "";
  flags += sample.is_in_contact ? "touch " : "";
  flags += sample.is_limited ? "limited " : "";
  flags += sample.is_stale ? "stale" : "";
  return plain(flags);
}

std::string row_of(const Sample& sample, double stop_s) {
  std::string row = right(fixed(1e3 * (sample.now_s - stop_s), 1), 9);
  row += " " + fit(plain(sample.state), 12) + fit(plain(sample.read), 10);
  row += right(fixed(norm(sample.velocity), 2), 7);
  row += right(fixed(norm(sample.wish), 2), 8) + right(fixed(norm(sample.force), 2), 7);
  row += right(fixed(1e3 * norm(sample.offset), 1), 7) + "  ";
  return fit(row + flags_of(sample), kColumns - 1) + "\n";
}

// Of the ticks that one row stands for: the stop, else the one with the hardest wish, else the
// last.
const Sample& chosen(const std::vector<Sample>& samples, std::size_t first, std::size_t end,
                     std::size_t stop) {
  if (stop >= first && stop < end) return samples[stop];
  std::size_t best = end - 1;
  for (std::size_t i = first; i < end; ++i) {
    if (is_worse(norm(samples[i].wish), norm(samples[best].wish))) best = i;
  }
  return samples[best];
}

std::string table(const Recording& recording, std::size_t stop, double before_s) {
  const auto& samples = recording.samples;
  const double stop_s = samples[stop].now_s;
  std::size_t first = stop;
  while (first > 0 && samples[first - 1].now_s >= stop_s - before_s) --first;
  const std::size_t end = std::min(samples.size(), stop + 3);
  const std::size_t rows = std::min(kMaxRows, end - first);
  std::string out = "  time ms state       device     speed    wish  force offset\n" +
                    std::string(32, ' ') + "    m/s       N      N     mm\n";
  for (std::size_t row = 0; row < rows; ++row) {
    const std::size_t from = first + row * (end - first) / rows;
    const std::size_t to = first + (row + 1) * (end - first) / rows;
    out += row_of(chosen(samples, from, to, stop), stop_s);
  }
  return out;
}

std::string heading(const Recording& recording, std::size_t stop) {
  const auto& samples = recording.samples;
  const double span_s = samples.back().now_s - samples.front().now_s;
  std::string out;
  for (const auto& [label, text] :
       {std::pair{"arm", plain(recording.arm) + "  " + plain(recording.device)},
        {"cause", plain(recording.cause)},
        {"held", std::to_string(samples.size()) + " ticks, " + fixed(span_s, 3) + " s; the fault " +
                     fixed(samples[stop].now_s - samples.front().now_s, 3) + " s in"}}) {
    out += fit(label, 8) + text.substr(0, kColumns - 9) + "\n";
  }
  return out + cli::wrap(plain(recording.meaning), kColumns - 1, 8);
}

}  // namespace

std::string render(const Recording& recording, double before_s, Glyphs glyphs) {
  const std::size_t stop = stop_of(recording);
  const std::array curves{
      Curve{"force sent", "N", 2, [](const Sample& s) { return norm(s.force); }},
      Curve{"tip speed", "m/s", 2, [](const Sample& s) { return norm(s.velocity); }},
      Curve{"offset of the frame", "mm", 1, [](const Sample& s) { return 1e3 * norm(s.offset); }}};
  std::string out = heading(recording, stop) + "\n";
  for (const Curve& curve : curves) out += plot(recording, curve, glyphs) + "\n";
  return out + table(recording, stop, before_s);
}

}  // namespace thimble::flight
