#include "daemon/api/json_text.hpp"

#include <algorithm>
#include <array>
#include <boost/json.hpp>
#include <charconv>
#include <cmath>

namespace thimble::api {
namespace {

void write(const boost::json::value& value, std::size_t indent, std::string& out);

void write_number(double value, std::string& out) {
  if (!std::isfinite(value)) {
    out += "null";
    return;
  }
  std::array<char, 32> buffer{};
  out.append(buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr);
}

void new_line(std::size_t indent, std::string& out) {
  out += '\n';
  out.append(indent, ' ');
}

void write_array(const boost::json::array& array, std::size_t indent, std::string& out) {
  const bool is_flat =
      std::all_of(array.begin(), array.end(), [](const auto& item) { return item.is_number(); });
  out += '[';
  for (std::size_t i = 0; i < array.size(); ++i) {
    if (i > 0) out += is_flat ? ", " : ",";
    if (!is_flat) new_line(indent + 2, out);
    write(array[i], indent + 2, out);
  }
  if (!is_flat) new_line(indent, out);
  out += ']';
}

void write_object(const boost::json::object& object, std::size_t indent, std::string& out) {
  out += '{';
  bool is_first = true;
  for (const auto& member : object) {
    if (!is_first) out += ',';
    is_first = false;
    new_line(indent + 2, out);
    out += boost::json::serialize(member.key()) + ": ";
    write(member.value(), indent + 2, out);
  }
  if (!is_first) new_line(indent, out);
  out += '}';
}

void write(const boost::json::value& value, std::size_t indent, std::string& out) {
  if (value.is_double()) return write_number(value.get_double(), out);
  if (value.is_array()) return write_array(value.get_array(), indent, out);
  if (value.is_object()) return write_object(value.get_object(), indent, out);
  out += boost::json::serialize(value);
}

}  // namespace

std::string to_text(const boost::json::value& value) {
  std::string out;
  write(value, 0, out);
  return out += '\n';
}

}  // namespace thimble::api
