#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace thimble::bench {

// DESIGN section 5 asks for at least five; odd, so that a median is the figure of one slice.
inline constexpr std::size_t kSlices = 7;

// What a figure should not exceed: itself, or its ratio to the reference.
struct Goal {
  enum class Of { Value, Ratio };
  Of of{Of::Value};
  double at_most{0};
};

// One figure of the table: medians over the slices, and the median of the slices' own ratios, so
// that a machine which grows slower in the middle of a run disturbs both sides of it alike.
struct Comparison {
  std::string name;
  std::string unit;
  double value{0};
  std::optional<double> reference{};
  std::optional<double> ratio{};
  Goal goal{};

  [[nodiscard]] bool is_met() const noexcept;
};

// Figures of one side, one a slice.
using Slices = std::vector<double>;

// Mean of the two in the middle for an even number; 0 of nothing.
[[nodiscard]] double median(Slices values);
// Slices whose reference is 0 give no ratio. `references` empty: a figure that stands alone.
[[nodiscard]] Comparison compare(std::string name, std::string unit, Goal goal,
                                 const Slices& values, const Slices& references);

// Both sides by turns, the one that goes first changing from slice to slice.
template <class Subject, class Reference>
void alternate(std::size_t slices, const Subject& subject, const Reference& reference) {
  for (std::size_t slice = 0; slice < slices; ++slice) {
    if (slice % 2 == 0) subject();
    reference();
    if (slice % 2 != 0) subject();
  }
}

// One line of JSON for bench/run_benchmarks.py, which makes the table for people and the file of
// --json of it.
[[nodiscard]] std::string to_json(const Comparison& comparison);
void print(const Comparison& comparison);

}  // namespace thimble::bench
