#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace thimble::doctor {

enum class Level : std::uint8_t {
  Ok,
  Warn,   // worse than it could be
  Wrong,  // arms cannot be driven, or not safely
};
[[nodiscard]] std::string_view to_string(Level level) noexcept;

// What one check found.
struct Verdict {
  Level level{Level::Ok};
  std::string check;    // short name, stable: "rtprio"
  std::string finding;  // what is so
  // Empty when all is well:
  std::string reason;       // why it matters
  std::string command;      // mends it, when typed into a shell; empty: no command can
  std::string advice;       // what else to do, or instead of a command
  std::string look_with{};  // a command that shows more and changes nothing; may be empty
  bool operator==(const Verdict&) const = default;
};

[[nodiscard]] Verdict all_well(std::string check, std::string finding);
// "process 77 of user 'haptics'"; a user without a name is a number.
[[nodiscard]] std::string process_of_user(int pid, std::uint32_t user,
                                          const std::string& user_name);
[[nodiscard]] bool is_something_wrong(const std::vector<Verdict>& verdicts) noexcept;

}  // namespace thimble::doctor
