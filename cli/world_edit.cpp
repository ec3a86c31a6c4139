#include "cli/world_edit.hpp"

#include <algorithm>
#include <array>
#include <boost/json.hpp>
#include <cmath>

namespace thimble::cli {
namespace {

namespace json = boost::json;

template <class Number>
json::array list_of(const std::vector<Number>& numbers) {
  return json::array(numbers.begin(), numbers.end());
}

constexpr double kMaxBrush_m = 1e6;  // docs/api.md

struct Option {
  const char* name;
  bool is_said;
  bool is_allowed;
  bool is_needed;  // if it is allowed
};

}  // namespace

bool is_about_state(const WorldEdit& edit) { return edit.verb == "save" || edit.verb == "load"; }

std::string find_misfit(const WorldEdit& edit) {
  const bool is_brush = edit.verb == "paint";
  const bool is_state = is_about_state(edit);
  const bool is_box = !is_brush && !is_state;
  const std::array<Option, 6> options{
      {{"--min", !edit.min.empty(), is_box, !edit.max.empty()},
       {"--max", !edit.max.empty(), is_box, !edit.min.empty()},
       {"--center", !edit.center_m.empty(), is_brush, is_brush},
       {"--radius", edit.radius_m.has_value(), is_brush, is_brush},
       {"--cell", edit.cell.has_value(), edit.verb != "clear" && !is_state, false},
       {"--file", !edit.file.empty(), is_state, is_state}}};
  for (const Option& option : options) {
    if (option.is_said && !option.is_allowed) {
      return std::string(option.name) + " does not go with " + edit.verb;
    }
  }
  for (const Option& option : options) {
    if (option.is_said || !option.is_needed) continue;
    const bool is_first = &option == options.data();
    const char* beside = !is_box ? "" : is_first ? " beside --max" : " beside --min";
    return edit.verb + " needs " + option.name + beside;
  }
  for (std::size_t axis = 0; axis < edit.min.size() && axis < edit.max.size(); ++axis) {
    if (edit.min[axis] > edit.max[axis]) {
      return std::string("--min is beyond --max along ") + "xyz"[axis];
    }
  }
  const bool is_center = std::all_of(edit.center_m.begin(), edit.center_m.end(),
                                     [](double at_m) { return std::abs(at_m) <= kMaxBrush_m; });
  if (!is_center) return "--center is farther than 1e6 m from the origin";
  const double radius_m = edit.radius_m.value_or(1);
  return radius_m > 0 && radius_m <= kMaxBrush_m ? "" : "--radius is not above 0 and up to 1e6 m";
}

std::string body_of(const WorldEdit& edit, const std::array<std::uint32_t, 3>& world_cells) {
  json::object keys;
  const bool is_brush = edit.verb == "paint";
  if (!edit.min.empty()) keys["min"] = list_of(edit.min);
  if (!edit.max.empty()) keys["max"] = list_of(edit.max);
  if (!is_brush && edit.min.empty() && edit.max.empty()) {
    json::array last;
    for (const std::uint32_t count : world_cells) last.push_back(count == 0 ? 0 : count - 1);
    keys["min"] = json::array{0, 0, 0};
    keys["max"] = std::move(last);
  }
  if (!edit.center_m.empty()) keys["center_m"] = list_of(edit.center_m);
  if (edit.radius_m) keys["radius_m"] = *edit.radius_m;
  if (edit.cell) keys["cell"] = *edit.cell;
  return json::serialize(json::object{{edit.verb, std::move(keys)}});
}

}  // namespace thimble::cli
