#pragma once

#include <boost/json/fwd.hpp>
#include <string_view>

#include "daemon/api/request.hpp"

namespace thimble::api {

// The document in a body. An object that says a key twice is refused, and the key named: one of
// the two would be dropped in silence, and who wrote both meant both.
// Pure and total: any bytes give a document or an error. Nested 32 deep at most (Boost.JSON's).
[[nodiscard]] tl::expected<boost::json::value, RequestError> parse_body(std::string_view body);

}  // namespace thimble::api
