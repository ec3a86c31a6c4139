#include <cstddef>
#include <cstdint>
#include <string_view>

#include "daemon/api/edits.hpp"
#include "daemon/api/request.hpp"
#include "hal/base/check.hpp"

// "METHOD TARGET BODY", split at the first two spaces.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  const std::size_t first = input.find(' ');
  const std::string_view method = input.substr(0, first);
  const std::string_view rest = first == std::string_view::npos ? "" : input.substr(first + 1);
  const std::size_t second = rest.find(' ');
  const std::string_view target = rest.substr(0, second);
  const std::string_view body = second == std::string_view::npos ? "" : rest.substr(second + 1);

  using thimble::api::ActionKind;
  const auto result = thimble::api::parse_request(method, target, body);
  if (!result) {
    THIMBLE_CHECK(result.error().http_status >= 400 && result.error().http_status < 500);
    THIMBLE_CHECK(!thimble::api::to_json(result.error()).empty());
    return 0;
  }
  const bool is_status = result->kind == ActionKind::Status;
  THIMBLE_CHECK(method == (is_status ? "GET" : "POST"));
  THIMBLE_CHECK(result->name.empty() == is_status);
  const bool has_edits = result->kind == ActionKind::EditWorld;
  THIMBLE_CHECK(has_edits == !result->edits.empty());
  THIMBLE_CHECK(result->edits.size() <= thimble::api::kMaxEdits);
  return 0;
}
