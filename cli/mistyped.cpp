#include "cli/mistyped.hpp"

#include <vector>

#include "daemon/config/report.hpp"

namespace thimble::cli {

std::string tell_mistyped(const CLI::App& app) {
  const CLI::App* of = &app;
  while (!of->get_subcommands().empty()) of = of->get_subcommands().back();
  if (of->get_require_subcommand_min() == 0) return "";
  const std::vector<std::string> left = app.remaining(true);
  if (left.empty()) return "";
  const std::string& word = left.front();
  // What stands behind an option that is not known is its value as likely as a subcommand.
  if (word.starts_with('-')) return "there is no option " + config::in_quotes(word);
  std::vector<std::string> names;
  for (const CLI::App* one : of->get_subcommands({})) names.push_back(one->get_name());
  const std::string_view meant = config::nearest(word, names);
  return "there is no subcommand " + config::in_quotes(word) +
         (meant.empty() ? "" : "; did you mean " + std::string(meant) + "?");
}

}  // namespace thimble::cli
