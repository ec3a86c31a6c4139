#include "cli/world_edit.hpp"

#include <boost/json.hpp>

namespace thimble::cli {
namespace {

namespace json = boost::json;

template <class Number>
json::array list_of(const std::vector<Number>& numbers) {
  return json::array(numbers.begin(), numbers.end());
}

}  // namespace

std::string find_misfit(const WorldEdit& edit) {
  const bool is_brush = edit.verb == "paint";
  const char* option = is_brush && !edit.min.empty()         ? "--min"
                       : is_brush && !edit.max.empty()       ? "--max"
                       : !is_brush && !edit.center_m.empty() ? "--center"
                       : !is_brush && edit.radius_m          ? "--radius"
                       : edit.verb == "clear" && edit.cell   ? "--cell"
                                                             : nullptr;
  return option == nullptr ? "" : std::string(option) + " does not go with " + edit.verb;
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
