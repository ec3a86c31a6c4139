#pragma once

#include <boost/json/fwd.hpp>
#include <string>

namespace thimble::api {

// JSON for people too: two spaces of indentation, arrays of numbers on one line, numbers in
// their shortest form. A number that is not finite becomes null. Ends in a line break.
[[nodiscard]] std::string to_text(const boost::json::value& value);

}  // namespace thimble::api
