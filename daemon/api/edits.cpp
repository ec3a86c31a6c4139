#include "daemon/api/edits.hpp"

#include <algorithm>
#include <boost/json.hpp>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>

namespace thimble::api {
namespace {

namespace json = boost::json;

constexpr std::string_view kShape =
    "expected an edit such as {\"fill\": {\"min\": [0, 0, 0], \"max\": [3, 3, 3]}}, or a list of "
    "up "
    "to 64: fill, clear or box with min and max, or paint with center_m and radius_m; cell besides "
    "clear";

// Reads one edit; the first thing that is wrong stays in `mistake`.
class EditReader {
 public:
  [[nodiscard]] std::optional<CellEdit> read(const json::value& value) {
    const json::object* edit = value.if_object();
    if (edit == nullptr || edit->size() != 1) return refuse(std::string(kShape));
    verb_ = std::string(edit->begin()->key());
    const json::object* keys = edit->begin()->value().if_object();
    if (keys == nullptr) return refuse(std::string(kShape));
    if (verb_ == "paint") return read_paint(*keys);
    if (verb_ == "fill" || verb_ == "clear" || verb_ == "box") return read_cells(*keys);
    return refuse(std::string(kShape));
  }
  [[nodiscard]] const std::string& mistake() const { return mistake_; }

 private:
  std::optional<CellEdit> refuse(std::string mistake) {
    mistake_ = std::move(mistake);
    return std::nullopt;
  }
  std::optional<CellEdit> refuse(std::string_view key, const std::string& expected) {
    return refuse(verb_ + "." + std::string(key) + ": expected " + expected);
  }

  std::optional<CellEdit> read_cells(const json::object& keys) {
    CellEdit edit;
    edit.kind = verb_ == "box" ? CellEdit::Kind::Box : CellEdit::Kind::Fill;
    if (!has_only(keys, {"min", "max", verb_ == "clear" ? "" : "cell"})) return std::nullopt;
    if (!read_index(keys, "min", edit.min) || !read_index(keys, "max", edit.max)) {
      return std::nullopt;
    }
    if (verb_ == "clear") edit.cell = 0;
    return read_cell(keys, edit);
  }

  std::optional<CellEdit> read_paint(const json::object& keys) {
    CellEdit edit;
    edit.kind = CellEdit::Kind::Paint;
    if (!has_only(keys, {"center_m", "radius_m", "cell"})) return std::nullopt;
    const json::value* center = keys.if_contains("center_m");
    const json::array* numbers = center == nullptr ? nullptr : center->if_array();
    if (numbers == nullptr || numbers->size() != 3) return refuse("center_m", "three numbers");
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::optional<double> number = finite((*numbers)[axis]);
      if (!number) return refuse("center_m", "three numbers");
      edit.center_m[axis] = *number;
    }
    const json::value* radius = keys.if_contains("radius_m");
    const std::optional<double> number = radius == nullptr ? std::nullopt : finite(*radius);
    if (!number || !(*number > 0)) return refuse("radius_m", "a number above 0");
    edit.radius_m = *number;
    return read_cell(keys, edit);
  }

  // An edit whose key is misspelt would do something else than was meant.
  bool has_only(const json::object& keys, std::initializer_list<std::string_view> known) {
    for (const auto& member : keys) {
      const std::string_view key(member.key().data(), member.key().size());
      if (!key.empty() && std::find(known.begin(), known.end(), key) != known.end()) continue;
      refuse("\"" + verb_ + "\" has a key that it does not know; " + std::string(kShape));
      return false;
    }
    return true;
  }

  bool read_index(const json::object& keys, std::string_view key,
                  std::array<std::int32_t, 3>& out) {
    const json::value* value = keys.if_contains(key);
    const json::array* numbers = value == nullptr ? nullptr : value->if_array();
    const bool is_triple = numbers != nullptr && numbers->size() == 3;
    for (std::size_t axis = 0; is_triple && axis < 3; ++axis) {
      const std::int64_t* number = (*numbers)[axis].if_int64();
      if (number == nullptr || *number < 0 || *number > std::numeric_limits<std::int32_t>::max()) {
        refuse(key, "three whole numbers from 0");
        return false;
      }
      out[axis] = static_cast<std::int32_t>(*number);
    }
    if (!is_triple) refuse(key, "three whole numbers from 0");
    return is_triple;
  }

  std::optional<CellEdit> read_cell(const json::object& keys, CellEdit edit) {
    const json::value* value = keys.if_contains("cell");
    if (value == nullptr) return edit;
    const std::int64_t* number = value->if_int64();
    if (number == nullptr || *number < 0 || *number > std::numeric_limits<std::uint8_t>::max()) {
      return refuse("cell", "a whole number: 0 free, 1 filled, 1 + n of the n-th material");
    }
    edit.cell = static_cast<std::uint8_t>(*number);
    return edit;
  }

  static std::optional<double> finite(const json::value& value) {
    if (!value.is_number()) return std::nullopt;
    const double number = value.is_double()  ? value.get_double()
                          : value.is_int64() ? static_cast<double>(value.get_int64())
                                             : static_cast<double>(value.get_uint64());
    return std::isfinite(number) ? std::optional(number) : std::nullopt;
  }

  std::string verb_;
  std::string mistake_;
};

}  // namespace

tl::expected<std::vector<CellEdit>, RequestError> parse_edits(const json::value& document) {
  std::vector<CellEdit> edits;
  EditReader reader;
  const json::array* list = document.if_array();
  if (list == nullptr) {
    const std::optional<CellEdit> edit = reader.read(document);
    if (!edit) return malformed(reader.mistake());
    return std::vector<CellEdit>{*edit};
  }
  if (list->empty() || list->size() > kMaxEdits) return malformed(std::string(kShape));
  for (const json::value& value : *list) {
    const std::optional<CellEdit> edit = reader.read(value);
    if (!edit) return malformed("edit " + std::to_string(edits.size()) + ": " + reader.mistake());
    edits.push_back(*edit);
  }
  return edits;
}

}  // namespace thimble::api
