#include "cli/doctor/verdict.hpp"

#include <algorithm>
#include <utility>

namespace thimble::doctor {

std::string_view to_string(Level level) noexcept {
  switch (level) {
    case Level::Ok:
      return "ok";
    case Level::Warn:
      return "warn";
    case Level::Wrong:
      return "wrong";
  }
  return "unknown";
}

Verdict all_well(std::string check, std::string finding) {
  return {Level::Ok, std::move(check), std::move(finding), "", "", ""};
}

std::string process_of_user(int pid, std::uint32_t user, const std::string& user_name) {
  return "process " + std::to_string(pid) + " of user " +
         (user_name.empty() ? std::to_string(user) : "'" + user_name + "'");
}

bool is_something_wrong(const std::vector<Verdict>& verdicts) noexcept {
  return std::any_of(verdicts.begin(), verdicts.end(),
                     [](const Verdict& verdict) { return verdict.level == Level::Wrong; });
}

}  // namespace thimble::doctor
