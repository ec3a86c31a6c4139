#include "tests/campaign/report.hpp"

#include <array>
#include <cstdio>

namespace thimble::campaign {
namespace {

template <class... Values>
std::string format(const char* pattern, Values... values) {
  std::array<char, 200> line{};
  std::snprintf(line.data(), line.size(), pattern, values...);
  return line.data();
}

std::string count(std::string_view name, std::uint64_t n) {
  return format("  %-20s %12llu\n", std::string(name).c_str(), static_cast<unsigned long long>(n));
}

constexpr std::array<const char*, sim::kFaultKindCount> kReportNames{
    "dropped in",      "dropped out",  "delayed in",     "delayed out", "corrupted in",
    "corrupted out",   "truncated in", "truncated out",  "stalled",     "handles killed",
    "opening refused", "events lost",  "events delayed", "halted",      "babbled"};

}  // namespace

std::string to_text(const Tally& tally) {
  std::string text = format("%llu episodes, %llu ticks, %.0f s of the arms' time\n",
                            static_cast<unsigned long long>(tally.episodes),
                            static_cast<unsigned long long>(tally.ticks), tally.played_s);
  text += count("in a sphere", tally.in_spheres) + count("in volumes", tally.in_volumes) +
          count("beside another arm", tally.with_bystander) +
          count("on bare USB", tally.on_bare_usb);
  text += "events\n";
  for (std::size_t i = 0; i < kEventKindCount; ++i) {
    text += count(to_string(static_cast<EventKind>(i)), tally.events[i]);
  }
  text += "faults of the bus\n";
  for (std::size_t i = 0; i < sim::kFaultKindCount; ++i) {
    text += count(kReportNames[i], tally.reports.by_kind[i]);
  }
  text += "messages on the link\n" + count("lost", tally.messages_lost) +
          count("duplicated", tally.messages_duplicated) +
          count("reordered", tally.messages_reordered);
  text += "ticks by state\n";
  for (std::size_t i = 0; i < kOperatingStateCount; ++i) {
    if (tally.ticks_in[i] == 0) continue;
    text += count(to_string(static_cast<OperatingState>(i)), tally.ticks_in[i]);
  }
  text += "faults latched\n";
  for (std::size_t i = 1; i < kFaultCodeCount; ++i) {
    text += count(to_string(static_cast<FaultCode>(i)), tally.latched[i]);
  }
  text += "and then\n" + count("cleared", tally.cleared) + count("arms lost", tally.unplugged) +
          count("driven again", tally.recoveries) + count("edits applied", tally.edits) +
          count("lies of worlds", tally.lies) + count("contacts", tally.contacts) +
          count("driven again on USB", tally.recoveries_on_usb) +
          count("ticks due on USB", tally.judged.ticks_due_on_usb) +
          count("touches judged", tally.judged.touches) +
          count("touches excused", tally.judged.excused_touches) +
          format("  %-20s %12.3f N\n", "largest force sent", tally.peak_newton);
  return text;
}

std::vector<std::string> never_struck(const Tally& tally) {
  std::vector<std::string> names;
  const auto look = [&](std::string_view name, std::uint64_t n) {
    if (n == 0) names.emplace_back(name);
  };
  for (std::size_t i = 0; i < kEventKindCount; ++i) {
    const auto kind = static_cast<EventKind>(i);
    if (!is_edit(kind)) look(to_string(kind), tally.events[i]);
  }
  for (std::size_t i = 0; i < sim::kFaultKindCount; ++i) {
    look(kReportNames[i], tally.reports.by_kind[i]);
  }
  look("messages lost", tally.messages_lost);
  look("messages duplicated", tally.messages_duplicated);
  look("messages reordered", tally.messages_reordered);
  look("lies of worlds", tally.lies);
  look("driven again on USB", tally.recoveries_on_usb);
  look("ticks due on USB", tally.judged.ticks_due_on_usb);
  return names;
}

}  // namespace thimble::campaign
