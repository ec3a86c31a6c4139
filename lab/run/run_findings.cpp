#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "lab/run/playable.hpp"
#include "lab/run/run.hpp"

// What a session that was played has to tell.
namespace thimble::lab {
namespace {

std::string hexadecimal(std::uint64_t number) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(number));
  return text;
}

std::string title_of(const std::vector<std::string>& files) {
  std::string title;
  for (const std::string& file : files) title += (title.empty() ? "" : " and ") + file;
  return title + " in virtual time";
}

Table arms_table() {
  return {.name = "arms",
          .title = "Arms",
          .columns = {{"arm", ""},
                      {"device", ""},
                      {"state", ""},
                      {"driven", "s", 1},
                      {"contacts", "", 0},
                      {"most_force", "N", 2},
                      {"most_offset", "mm", 2},
                      {"given", "mJ", 3},
                      {"samples", "", 0},
                      {"replies", "", 0},
                      {"lost", "", 0},
                      {"round_trip", "ms", 1},
                      {"missed_reports", "", 0},
                      {"faults", "", 0},
                      {"trace_hash", ""}},
          .rows = {}};
}

std::vector<Cell> arm_row(const std::string& name, session::ArmRig& rig, const ArmTrace& trace) {
  const servo::ServoSnapshot& last = rig.session().snapshot();
  const link::LinkStatus link = rig.link_status();
  const config::ArmConfig& said = rig.session().config();
  return {name,
          said.device,
          std::string(to_string(last.frame.state)),
          trace.driven_s,
          static_cast<double>(last.total_contacts),
          last.peak_force_newton,
          1e3 * last.peak_offset_m,
          1e3 * last.frame.generated_energy_j,
          static_cast<double>(link.counters.sent),
          static_cast<double>(link.counters.accepted),
          static_cast<double>(link.counters.lost),
          1e3 * seconds(link.round_trip),
          static_cast<double>(last.missed_exchanges),
          static_cast<double>(last.faults),
          hexadecimal(trace.hash.value())};
}

std::vector<Column> trace_columns() {
  std::vector<Column> columns{{"time", "s"}};
  const std::pair<const char*, const char*> vectors[] = {
      {"tip", "m"}, {"velocity", "m/s"}, {"offset", "m"}, {"wish", "N"}, {"force", "N"}};
  for (const auto& [name, unit] : vectors) {
    for (const char* axis : {"_x", "_y", "_z"}) {
      columns.push_back({std::string(name) + axis, unit});
    }
  }
  columns.push_back({"gain", ""});
  columns.push_back({"in_contact", ""});
  columns.push_back({"state", ""});
  return columns;
}

Table trace_table(const std::string& name, const std::string& arm, const ArmTrace& trace,
                  MonotonicTime began) {
  Table table{.name = name,
              .title = "Arm '" + arm + "'",
              .columns = trace_columns(),
              .rows = {},
              .is_for_files = true};
  for (const servo::ServoFrame& frame : trace.frames) {
    std::vector<Cell> row{seconds(frame.now - began)};
    const auto add = [&](const auto& v) {
      for (std::size_t axis = 0; axis < 3; ++axis) row.emplace_back(v[axis]);
    };
    add(frame.tip);
    add(frame.velocity);
    add(frame.offset);
    add(frame.wish);
    add(frame.force);
    row.emplace_back(frame.gain);
    row.emplace_back(frame.is_in_contact ? 1.0 : 0.0);
    row.emplace_back(std::string(to_string(frame.state)));
    table.rows.push_back(std::move(row));
  }
  return table;
}

// Three axes of something over time.
Plot plot_of(const std::string& name, const std::string& title, const std::string& y_label,
             const ArmTrace& trace, MonotonicTime began, const auto& value) {
  Plot plot{
      .name = name, .title = title, .x = {"time [s]", false}, .y = {y_label, false}, .series = {}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Series series{std::string(1, static_cast<char>('x' + axis)), Mark::Line, {}};
    for (const servo::ServoFrame& frame : trace.frames) {
      series.points.emplace_back(seconds(frame.now - began), value(frame)[axis]);
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

// What a status says of a link that is not up at the end.
std::string trouble_of(const link::LinkStatus& link) {
  const std::string trouble = link.last_error.empty() ? "nobody answers" : link.last_error;
  const std::uint64_t errors = link.counters.receive_errors;
  return errors == 0 ? trouble : trouble + "; receive errors: " + std::to_string(errors);
}

// Of links to other files, and of who listens to them but in vain; `whose`: "", or "host: ".
std::vector<std::string> link_troubles(session::Runtime& runtime, const std::string& whose) {
  std::vector<std::string> troubles;
  for (const auto& arm : runtime.arms()) {
    const config::ArmConfig& said = arm->session().config();
    const link::LinkStatus link = arm->link_status();
    const bool is_linked = said.link || said.line;
    if (!is_linked || link.is_up) continue;
    troubles.push_back(whose + "arm '" + said.name + "': link: " + trouble_of(link));
  }
  const auto tell = [&](const std::string& who, const link::LinkStatus& link) {
    if (link.is_up || link.last_error.empty()) return;
    troubles.push_back(whose + who + "': listen: " + trouble_of(link));
  };
  for (const auto& world : runtime.worlds()) {
    if (const auto link = world->listener_status()) tell("world '" + world->name(), *link);
  }
  for (const auto& arm : runtime.arm_hosts()) {
    tell("arm '" + arm->name(), arm->listener().status());
  }
  return troubles;
}

// Of the worlds of that file that have a network of their own.
void add_network_seeds(const PlayedFile& file, Findings& findings) {
  for (const config::WorldConfig& world : file.config.worlds) {
    if (!world.impairment) continue;
    findings.parameters.push_back({"network_seed of " + file.name + ": " + world.name, "",
                                   static_cast<double>(world.impairment->seed)});
  }
}

}  // namespace

Findings SessionRun::findings() const {
  Findings findings{.experiment = "run",
                    .title = title_of(settings_.files),
                    .parameters = {{"virtual_time", "s", settings_.for_s},
                                   {"servo_rate", "Hz", servo_rate_hz(files_)},
                                   {"ticks_per_row", "", static_cast<double>(shown_every_)}},
                    .tables = {arms_table()},
                    .plots = {},
                    .criteria = {{"no arm stopped for a fault", true}},
                    .remarks = session_->troubles()};
  for (std::size_t i = 0; i < files_.size(); ++i) {
    const std::string number = i == 0 ? "" : "_" + std::to_string(i + 1);
    findings.parameters.insert(findings.parameters.begin() + static_cast<std::ptrdiff_t>(i),
                               {"file" + number, "", settings_.files[i]});
    const std::string whose = files_.size() > 1 ? files_[i].name + ": " : "";
    for (std::string& trouble : link_troubles(session_->runtime(i), whose)) {
      findings.remarks.push_back(std::move(trouble));
    }
    if (!files_[i].config.safety) continue;
    findings.remarks.push_back(files_[i].name +
                               ": safety: its lines are watched in real time; "
                               "nobody presses the stop here, and the deadman is held");
  }
  for (std::size_t i = 0; i < files_.size(); ++i) {
    findings.parameters.push_back(
        {"configuration" + (i == 0 ? "" : "_" + std::to_string(i + 1)), "", files_[i].text});
    add_network_seeds(files_[i], findings);
  }
  for (const std::string& override : settings_.overrides) {
    findings.parameters.push_back({"set " + override.substr(0, override.find('=')), "", override});
  }
  const MonotonicTime began = session_->began();
  for (std::size_t i = 0; i < traces_.size(); ++i) {
    session::ArmRig& rig = session_->arm(i);
    const config::ArmConfig& said = rig.session().config();
    const std::string number = std::to_string(i + 1);
    const ArmTrace& trace = traces_[i];
    findings.tables[0].rows.push_back(arm_row(name_of(i), rig, trace));
    findings.tables.push_back(trace_table("trace-" + number, name_of(i), trace, began));
    if (said.hand) {
      findings.parameters.push_back(
          {"hand_seed_" + number, "", static_cast<double>(said.hand->seed)});
    }
    if (said.impairment) {
      findings.parameters.push_back(
          {"network_seed_" + number, "", static_cast<double>(said.impairment->seed)});
    }
    if (rig.session().snapshot().faults > 0) findings.criteria[0].is_met = false;
    const std::string who = "Arm '" + name_of(i) + "': ";
    findings.plots.push_back(plot_of("tip-" + number, who + "where the tip is", "tip [m]", trace,
                                     began, [](const auto& frame) { return frame.tip; }));
    findings.plots.push_back(plot_of("force-" + number, who + "force, after the limiter",
                                     "force [N]", trace, began,
                                     [](const auto& frame) { return frame.force; }));
    if (!(rig.session().snapshot().peak_offset_m > 0)) continue;
    findings.plots.push_back(plot_of("offset-" + number, who + "offset of the frame", "offset [m]",
                                     trace, began, [](const auto& frame) { return frame.offset; }));
  }
  return findings;
}

}  // namespace thimble::lab
