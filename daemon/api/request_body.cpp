#include "daemon/api/request_body.hpp"

#include <algorithm>
#include <boost/json.hpp>
#include <boost/json/basic_parser_impl.hpp>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace thimble::api {
namespace {

namespace json = boost::json;

constexpr std::size_t kLongestNamedKey = 64;  // bytes; ours

// What Boost.JSON calls while it reads. It keeps the keys of the objects that are open, and stops
// at the first that is there already. A body has few bytes, so a list is searched.
class KeyCheck {
 public:
  // NOLINTBEGIN(readability-identifier-naming): Boost.JSON's own names
  static constexpr std::size_t max_object_size = std::numeric_limits<std::size_t>::max();
  static constexpr std::size_t max_array_size = std::numeric_limits<std::size_t>::max();
  static constexpr std::size_t max_key_size = std::numeric_limits<std::size_t>::max();
  static constexpr std::size_t max_string_size = std::numeric_limits<std::size_t>::max();
  // NOLINTEND(readability-identifier-naming)

  // Whether key() was there already; it may be empty.
  [[nodiscard]] bool is_repeated() const { return is_repeated_; }
  [[nodiscard]] const std::string& key() const { return key_; }

  bool on_object_begin(json::error_code&) {
    open_.emplace_back();
    return true;
  }
  bool on_object_end(std::size_t, json::error_code&) {
    open_.pop_back();
    return true;
  }
  bool on_key_part(json::string_view part, std::size_t, json::error_code&) {
    key_.append(part.data(), part.size());
    return true;
  }
  bool on_key(json::string_view part, std::size_t, json::error_code& error) {
    key_.append(part.data(), part.size());
    std::vector<std::string>& keys = open_.back();
    is_repeated_ = std::find(keys.begin(), keys.end(), key_) != keys.end();
    if (is_repeated_) {
      error = json::error::syntax;
      return false;
    }
    keys.push_back(std::exchange(key_, {}));
    return true;
  }

  // The rest is of no interest here.
  static bool on_document_begin(json::error_code&) { return true; }
  static bool on_document_end(json::error_code&) { return true; }
  static bool on_array_begin(json::error_code&) { return true; }
  static bool on_array_end(std::size_t, json::error_code&) { return true; }
  static bool on_string_part(json::string_view, std::size_t, json::error_code&) { return true; }
  static bool on_string(json::string_view, std::size_t, json::error_code&) { return true; }
  static bool on_number_part(json::string_view, json::error_code&) { return true; }
  static bool on_int64(std::int64_t, json::string_view, json::error_code&) { return true; }
  static bool on_uint64(std::uint64_t, json::string_view, json::error_code&) { return true; }
  static bool on_double(double, json::string_view, json::error_code&) { return true; }
  static bool on_bool(bool, json::error_code&) { return true; }
  static bool on_null(json::error_code&) { return true; }
  static bool on_comment_part(json::string_view, json::error_code&) { return true; }
  static bool on_comment(json::string_view, json::error_code&) { return true; }

 private:
  std::vector<std::vector<std::string>> open_;
  std::string key_;
  bool is_repeated_{false};
};

}  // namespace

tl::expected<json::value, RequestError> parse_body(std::string_view body) {
  json::basic_parser<KeyCheck> check{json::parse_options()};
  json::error_code error;
  check.write_some(false, body.data(), body.size(), error);
  if (check.handler().is_repeated()) {
    const std::string& key = check.handler().key();
    // Quoted as JSON has it: no byte of it starts a line, or reaches a terminal as a command.
    const std::string name =
        key.size() <= kLongestNamedKey ? "the key " + json::serialize(key) : "a long key";
    return malformed("the body says " + name + " twice in one object");
  }
  json::value document = json::parse({body.data(), body.size()}, error);
  if (error) return malformed("the body is no JSON");
  return document;
}

}  // namespace thimble::api
