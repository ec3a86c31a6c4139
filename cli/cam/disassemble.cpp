#include "cli/cam/disassemble.hpp"

#include <cstdint>
#include <iostream>

#include "cli/commands.hpp"
#include "cli/file_text.hpp"
#include "cli/text.hpp"
#include "drivers/cambus/step_list_text.hpp"

namespace thimble::cam {
namespace {

std::string counted(std::uint64_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

std::string summary_text(const cambus::ListSummary& summary) {
  std::string text = counted(summary.steps, "step") + ", " + counted(summary.words, "word") + ", " +
                     counted(summary.runs, "run") + ", " + counted(summary.reads, "read");
  if (summary.loops) text += "; goes round until another list is given";
  return text + "\n";
}

}  // namespace

Result<ListReport> report_list(std::string_view file, const cambus::ListLimits& limits) {
  if (file.size() > kMaxListBytes) {
    return fail(Errc::TooLarge, "has more than " + std::to_string(kMaxListBytes >> 20) + " MiB");
  }
  const auto list = cambus::parse_list_file(file);
  if (!list) return tl::unexpected(list.error());
  ListReport report;
  report.text = cambus::disassemble(list->view(), list->head);
  const auto summary = cambus::check_step_list(list->view(), list->head, limits);
  if (summary) {
    report.text += summary_text(*summary);
  } else {
    report.refusal = summary.error().message;
  }
  return report;
}

int run_disassemble(const std::string& file, const cambus::ListLimits& limits) {
  // One byte more than is allowed, so that the parser can say so.
  const auto report =
      cli::read_at_most(file, kMaxListBytes + 1).and_then([&](const std::string& text) {
        return report_list(text, limits);
      });
  if (!report) {
    std::cerr << "thimble: " << cli::plain(file) << ": " << report.error().message << '\n';
    return cli::kExitRefused;
  }
  std::cout << report->text;
  if (report->refusal.empty()) return cli::kExitOk;
  std::cerr << "thimble: " << cli::plain(file) << ": no board is given this: " << report->refusal
            << '\n';
  return cli::kExitRefused;
}

}  // namespace thimble::cam
