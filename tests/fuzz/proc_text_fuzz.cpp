#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "cli/doctor/access_list.hpp"
#include "cli/doctor/proc_text.hpp"
#include "cli/service_state.hpp"
#include "hal/base/check.hpp"

// Any bytes that a file below /proc, /sys or /etc may hold give values or nothing.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thimble::doctor;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  for (const auto& word : words_of(bytes)) THIMBLE_CHECK(trimmed(word) == word && !word.empty());
  static_cast<void>(parse_integer(bytes));
  static_cast<void>(parse_hexadecimal(bytes));
  static_cast<void>(parse_limit(bytes, "Max locked memory"));
  static_cast<void>(parse_group(bytes, "thimble"));
  THIMBLE_CHECK(parse_user(bytes, 0).size() <= size);
  THIMBLE_CHECK(parse_memberships(bytes, "an").size() <= size);
  static_cast<void>(parse_primary_group(bytes, "an"));
  THIMBLE_CHECK(parse_service(bytes).find('/') == std::string::npos);
  const auto ids = parse_hid_ids(bytes);
  if (ids) THIMBLE_CHECK(ids->serial_number.size() <= size);
  const auto service = thimble::cli::parse_service_state(bytes);
  if (service) THIMBLE_CHECK(!service->active.empty() && service->result.size() <= size);
  Process process;
  parse_status(bytes, process);
  THIMBLE_CHECK(process.groups.size() <= size);
  const auto list = parse_access_list(std::as_bytes(std::span(data, size)));
  if (list) THIMBLE_CHECK((list->users.size() + list->groups.size()) * 8 <= size);
  return 0;
}
