#include "cli/doctor/report.hpp"

#include <algorithm>
#include <boost/json.hpp>

#include "cli/text.hpp"
#include "daemon/api/json_text.hpp"

namespace thimble::doctor {
namespace {

constexpr std::size_t kColumns = 80;
constexpr std::size_t kIndent = 7;  // columns of "WRONG  "

std::string_view label(Level level) {
  return level == Level::Ok ? "ok" : level == Level::Warn ? "warn" : "WRONG";
}

// The label and the first line on one line, the rest below it.
std::string paragraph(std::string_view head, const std::string& text) {
  std::string out = cli::wrap(cli::plain(text), kColumns, kIndent);
  return out.replace(0, std::min(kIndent, out.size()), cli::fit(head, kIndent));
}

// Never cut, so that it can be copied.
std::string command_line(const char* head, const std::string& command) {
  if (command.empty()) return "";
  return std::string(kIndent, ' ') + head + cli::plain(command) + "\n";
}

std::size_t count(const std::vector<Verdict>& verdicts, Level level) {
  return static_cast<std::size_t>(
      std::count_if(verdicts.begin(), verdicts.end(),
                    [level](const Verdict& verdict) { return verdict.level == level; }));
}

}  // namespace

std::string render(const std::vector<Verdict>& verdicts) {
  std::string out;
  for (const Verdict& verdict : verdicts) {
    out += paragraph(label(verdict.level), verdict.check + ": " + verdict.finding);
    if (!verdict.reason.empty()) out += paragraph("", "why: " + verdict.reason);
    out += command_line("mend: ", verdict.command) + command_line("look: ", verdict.look_with);
    if (!verdict.advice.empty()) out += paragraph("", "(" + verdict.advice + ")");
  }
  return out + std::to_string(count(verdicts, Level::Ok)) + " ok, " +
         std::to_string(count(verdicts, Level::Warn)) + " to improve, " +
         std::to_string(count(verdicts, Level::Wrong)) + " wrong\n";
}

std::string to_json(const std::vector<Verdict>& verdicts) {
  boost::json::array checks;
  for (const Verdict& verdict : verdicts) {
    checks.push_back(boost::json::object{{"check", cli::plain(verdict.check)},
                                         {"level", to_string(verdict.level)},
                                         {"finding", cli::plain(verdict.finding)},
                                         {"reason", verdict.reason},
                                         {"command", cli::plain(verdict.command)},
                                         {"advice", verdict.advice},
                                         {"look_with", cli::plain(verdict.look_with)}});
  }
  return api::to_text(
      boost::json::object{{"checks", std::move(checks)}, {"wrong", is_something_wrong(verdicts)}});
}

}  // namespace thimble::doctor
