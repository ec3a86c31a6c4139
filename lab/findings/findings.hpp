#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

// What an experiment found, so that one piece of code tells people of it, writes its files and
// draws its plots.
namespace thimble::lab {

// A number, or what stands where there is none. NaN is written as an empty cell.
using Cell = std::variant<double, std::string>;

// Given to the experiment, or fixed in it. `unit` is empty where there is none.
struct Parameter {
  std::string name;
  std::string unit;
  Cell value;
};

struct Column {
  std::string name;  // as in a file: letters, digits, underscores
  std::string unit;
  int decimals{3};  // shown to people; files have all digits
};

struct Table {
  std::string name;  // part of a file's name
  std::string title;
  std::vector<Column> columns;
  std::vector<std::vector<Cell>> rows;  // each as long as `columns`
  bool is_for_files{false};             // too long to be told to people
};

// Dashed: of theory.
enum class Mark { Line, Points, LinePoints, Dashed };

struct Series {
  std::string label;  // empty: none, where it goes with the one before
  Mark mark{Mark::LinePoints};
  std::vector<std::pair<double, double>> points;  // not finite: a gap
  // Shape and color of its marks, from 1; what belongs together has the same. 0: by its place.
  int style{0};
};

struct Axis {
  std::string label;  // with its unit
  bool is_logarithmic{false};
};

struct Plot {
  std::string name;  // part of a file's name
  std::string title;
  Axis x;
  Axis y;
  std::vector<Series> series;
};

// What must hold, for the exit code.
struct Criterion {
  std::string text;
  bool is_met{false};
};

struct Findings {
  std::string experiment;  // as on the command line
  std::string title;
  std::vector<Parameter> parameters;
  std::vector<Table> tables;
  std::vector<Plot> plots;
  std::vector<Criterion> criteria;
  std::vector<std::string> remarks;  // a sentence each

  [[nodiscard]] bool is_met() const noexcept;  // all criteria
};

// Tables, remarks and criteria for people, as plain text with lines that end in '\n'. Pure.
[[nodiscard]] std::string tell(const Findings& findings);

}  // namespace thimble::lab
