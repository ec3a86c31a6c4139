#include "cli/names.hpp"

#include "cli/text.hpp"
#include "daemon/config/name.hpp"

namespace thimble::cli {

std::string refuse_no_name(const std::string& text) {
  if (config::is_name(text)) return "";
  return "expected a name of 1 to " + std::to_string(config::kMaxNameBytes) +
         " of a-z, 0-9 and -, found \"" + plain(text) + "\"";
}

}  // namespace thimble::cli
