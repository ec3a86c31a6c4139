#include "bench/comparison.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

#include "hal/base/check.hpp"

namespace thimble::bench {
namespace {

template <class... Arguments>
std::string formatted(const char* format, Arguments... arguments) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), format, arguments...);
  return text.data();
}

// 17 digits: whoever reads it back has the same number.
std::string figure(std::optional<double> value) {
  return value ? formatted("%.17g", *value) : std::string("null");
}

}  // namespace

bool Comparison::is_met() const noexcept {
  if (goal.of == Goal::Of::Value) return value <= goal.at_most;
  return ratio && *ratio <= goal.at_most;
}

double median(Slices values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  if (values.size() % 2 != 0) return values[middle];
  return (values[middle - 1] + values[middle]) / 2;
}

Comparison compare(std::string name, std::string unit, Goal goal, const Slices& values,
                   const Slices& references) {
  Comparison comparison{std::move(name), std::move(unit), median(values), {}, {}, goal};
  if (references.empty()) return comparison;
  comparison.reference = median(references);
  Slices ratios;
  for (std::size_t i = 0; i < std::min(values.size(), references.size()); ++i) {
    if (references[i] > 0) ratios.push_back(values[i] / references[i]);
  }
  if (!ratios.empty()) comparison.ratio = median(ratios);
  return comparison;
}

std::string to_json(const Comparison& c) {
  THIMBLE_CHECK((c.name + c.unit).find_first_of("\"\\\n") == std::string::npos);
  const char* const of = c.goal.of == Goal::Of::Ratio ? "ratio" : "value";
  return "{\"name\": \"" + c.name + "\", \"unit\": \"" + c.unit +
         "\", \"value\": " + figure(c.value) + ", \"reference\": " + figure(c.reference) +
         ", \"ratio\": " + figure(c.ratio) + ", \"goal\": {\"of\": \"" + of +
         "\", \"at_most\": " + figure(c.goal.at_most) +
         "}, \"is_met\": " + (c.is_met() ? "true" : "false") + "}";
}

void print(const Comparison& comparison) {
  std::puts(to_json(comparison).c_str());
  std::fflush(stdout);
}

}  // namespace thimble::bench
