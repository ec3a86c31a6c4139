#include "cli/render.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "cli/finger_map.hpp"

namespace thimble::cli {
namespace {

constexpr std::size_t kLabel = 13;       // columns of "  position   "
constexpr double kFullBar_newton = 8.5;  // a PHANToM's peak (reference: its data sheet)

using Lines = std::vector<std::string>;

// What has no room goes on in the next line, below what stands behind the label.
void add(Lines& lines, const std::string& label, const std::string& text) {
  if (text.empty()) return lines.push_back(fit("  " + label, kLabel));
  const std::size_t first = lines.size();
  const std::string wrapped = wrap(text, kColumns, kLabel);
  std::size_t begin = 0;
  for (std::size_t end = wrapped.find('\n'); end != std::string::npos;
       begin = end + 1, end = wrapped.find('\n', begin)) {
    lines.push_back(wrapped.substr(begin, end - begin));
  }
  lines[first].replace(0, kLabel, fit("  " + label, kLabel));
}

void add_plain(Lines& lines, const std::string& label, const std::string& text) {
  add(lines, label, plain(text));
}

// One line, as a rule, that begins at the margin.
void add_heading(Lines& lines, const std::string& text) {
  const std::string first = wrap(text, kColumns, 0);
  const std::size_t size = std::min(first.find('\n'), first.size());
  lines.push_back(first.substr(0, size));
  const std::size_t rest = std::min(text.find_first_not_of(' ', size), text.size());
  if (rest < text.size()) add(lines, "", text.substr(rest));
}

std::string upper(std::string text) {
  for (char& c : text) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return text;
}

double norm(const std::array<double, 3>& v) { return std::hypot(v[0], v[1], v[2]); }

std::string vector_text(const std::array<double, 3>& v, double scale, int decimals,
                        const char* unit) {
  std::string out;
  for (const double component : v) {
    const std::string text = signed_fixed(component * scale, decimals);
    out.append(text.size() < 7 ? 7 - text.size() : 1, ' ') += text;
  }
  return out + " " + unit;
}

std::string percentiles_text(const api::Percentiles& p, Glyphs glyphs) {
  return "p50 " + time_text(p.p50, glyphs) + "  p99 " + time_text(p.p99, glyphs) + "  max " +
         time_text(p.max, glyphs);
}

void add_gimbal(Lines& lines, const api::ArmStatus& arm) {
  if (arm.gimbal_rad.empty()) return;
  std::string text;
  for (const double angle_rad : arm.gimbal_rad) {
    const std::string number = signed_fixed(angle_rad * 180 / std::numbers::pi, 1);
    text.append(number.size() < 7 ? 7 - number.size() : 1, ' ') += number;
  }
  add(lines, "gimbal", text + " degrees");
}

// What the cells of a world press back with; it is in the force already.
void add_pressure(Lines& lines, const api::FeltStatus& felt) {
  if (!felt.pressure_newton) return;
  add(lines, "pressure",
      vector_text(*felt.pressure_newton, 1, 2, "N ") + "   " +
          fit(fixed(norm(*felt.pressure_newton), 2), 6) + "of cells, as the world has it");
}

void add_motion(Lines& lines, const api::ArmStatus& arm, Glyphs glyphs) {
  const double force_newton = norm(arm.force_newton);
  add(lines, "position",
      fit(vector_text(arm.position_m, 1e3, 1, "mm"), 26) + "offset" +
          vector_text(arm.offset_m, 1e3, 1, "mm") + " peak " + fixed(arm.peak_offset_m * 1e3, 1));
  add_gimbal(lines, arm);
  add(lines, "force",
      vector_text(arm.force_newton, 1, 2, "N ") + "   " + fit(fixed(force_newton, 2), 6) + "[" +
          bar(force_newton / kFullBar_newton, 20, glyphs) + "]  peak " +
          fixed(arm.peak_force_newton, 2));
  add_pressure(lines, arm.felt);
  add(lines, "contact",
      std::string(arm.is_in_contact ? "  TOUCHING" : "  free    ") + "   " +
          std::to_string(arm.contacts) + " so far   constraints " + plain(arm.constraint_state));
}

void add_servo(Lines& lines, const api::ServoStatus& servo, Glyphs glyphs) {
  add(lines, "servo",
      (servo.rate_hz ? fixed(*servo.rate_hz, 0) : "-") + " Hz" +
          (servo.is_realtime ? " real-time" : " best-effort") + "  ticks " +
          std::to_string(servo.ticks) + "  overruns " + std::to_string(servo.overruns));
  add(lines, "wake-up", percentiles_text(servo.wakeup_error_s, glyphs));
  add(lines, "compute",
      "p99 " + time_text(servo.compute_s.p99, glyphs) + "  exchange p99 " +
          time_text(servo.exchange_s.p99, glyphs));
}

// Within one program there is nothing that could be down: nothing was exchanged lately, as while
// no arm is active.
std::string word_of(const api::LinkStatus& link) {
  if (link.is_up) return " up";
  return link.kind == "in-process" ? " idle" : " DOWN";
}

void add_link(Lines& lines, const api::LinkStatus& link, Glyphs glyphs) {
  add(lines, "link",
      plain(link.kind) + word_of(link) + "  round trip " +
          (link.is_up ? time_text(link.round_trip_s, glyphs) : "-") +
          (link.peer.empty() ? "" : "  peer " + plain(link.peer)));
  add(lines, "",
      "sent " + std::to_string(link.sent) + "  received " + std::to_string(link.received) +
          "  lost " + std::to_string(link.lost) + "  rejected " + std::to_string(link.rejected) +
          "  stale " + std::to_string(link.stale));
  if (!link.scheme.empty()) {
    add_plain(
        lines, "",
        "scheme " + link.scheme + (link.scheme_reason.empty() ? "" : ": " + link.scheme_reason));
  }
  if (link.is_up && link.clocks) {
    add(lines, "",
        "way there " + time_text(link.clocks->way_there_s, glyphs) + "  back " +
            time_text(link.clocks->way_back_s, glyphs) + "  clock off by " +
            fixed(1e3 * link.clocks->offset_s, 3) + " ms within " +
            time_text(link.clocks->offset_error_s, glyphs) +
            (link.peer_world.empty() ? "" : "  world " + plain(link.peer_world)) +
            (link.peer_arm.empty() ? "" : "  arm " + plain(link.peer_arm)));
  }
  if (link.is_up) return;
  if (!link.last_error.empty()) {
    add_plain(lines, "", "last trouble: " + link.last_error);
  } else if (link.kind != "in-process" && !link.arm.empty() && link.sent > 0) {
    // Whoever has another key is not answered, and not told so: he might be anybody.
    add_plain(lines, "",
              "no answer: does the other daemon run, at that address, with the same key?");
  }
}

void add_faults(Lines& lines, const api::ArmStatus& arm) {
  if (arm.faults.empty()) return add(lines, "faults", "none");
  for (const api::FaultStatus& fault : arm.faults) {
    const std::string number = fault.number == 0 ? "" : std::to_string(fault.number) + " ";
    add_plain(lines, "FAULT",
              number + fault.code + " at " + fixed(fault.at_s, 1) + " s: " + fault.message);
    if (!fault.recording.empty()) add_plain(lines, "", "recording " + fault.recording);
  }
}

void add_arm(Lines& lines, const api::Status& status, const api::ArmStatus& arm, Glyphs glyphs) {
  const std::string lease = arm.lease.empty() || arm.lease == "none" ? "nobody" : arm.lease;
  add_heading(lines, "arm " + plain(arm.name) + "  " + upper(plain(arm.state)) + "  " +
                         plain(arm.device) + "  calibration " + plain(arm.calibration) +
                         "  held by " + plain(lease));
  if (!arm.instruction.empty()) add_plain(lines, "PLEASE", arm.instruction);
  add_motion(lines, arm, glyphs);
  for (const api::ServoStatus& servo : status.servos) {
    if (servo.arm == arm.name) add_servo(lines, servo, glyphs);
  }
  for (const api::LinkStatus& link : status.links) {
    if (link.arm == arm.name) add_link(lines, link, glyphs);
  }
  add_faults(lines, arm);
}

// Nothing of a world that has none.
std::string cells_of(const api::WorldStatus& world) {
  if (world.cells[0] == 0) return "";
  return "  " + std::to_string(world.cells[0]) + " x " + std::to_string(world.cells[1]) + " x " +
         std::to_string(world.cells[2]) + " cells of " + fixed(world.cell_m * 1e3, 2) + " mm";
}

std::string pieces_of(const api::WorldStatus& world) {
  if (!world.pieces) return "";
  const std::uint32_t held = world.pieces->held;
  return (held == 0 ? "  holds no piece" : "  holds piece " + std::to_string(held)) +
         (world.pieces->is_free_motion ? "  free motion" : "");
}

void add_worlds(Lines& lines, const api::Status& status, Glyphs glyphs) {
  for (const api::WorldStatus& world : status.worlds) {
    add_heading(lines, "world " + plain(world.name) + "  " + plain(world.source) + cells_of(world) +
                           "  fingers " + std::to_string(world.probes) + pieces_of(world));
    for (const api::LinkStatus& link : status.links) {
      if (link.arm.empty() && link.world == world.name) add_link(lines, link, glyphs);
    }
  }
}

void add_safety(Lines& lines, const api::Status& status) {
  if (!status.safety) return;
  const api::SafetyStatus& safety = *status.safety;
  const char* deadman = safety.is_deadman_held        ? "held"
                        : safety.must_release_deadman ? "LET GO FIRST"
                                                      : "OPEN";
  add_heading(lines, "safety " + plain(safety.chip) + "  " + upper(plain(safety.state)) +
                         "  deadman " + deadman + "  enable " +
                         (safety.is_enable_beating ? "beats" : "rests") + "  stops " +
                         std::to_string(safety.stops));
  if (!safety.message.empty()) add_plain(lines, "", safety.message);
}

// A picture has a few lines for what is not as it should be: it stays the same from one to the
// next.
constexpr std::size_t kDegradedLinesOfAPicture = 2;

Lines degraded_lines(const api::Status& status, std::size_t most) {
  Lines lines;
  for (const std::string& sentence : status.degraded) add_plain(lines, "DEGRADED", sentence);
  if (lines.size() <= most) return lines;
  lines.resize(most);
  add(lines, "", "and more: thimble status tells the rest");
  return lines;
}

Lines all_lines(const api::Status& status, Glyphs glyphs, std::size_t most_degraded) {
  Lines lines;
  add_heading(lines, "thimble " + plain(status.version) + "  up " + uptime_text(status.uptime_s));
  const Lines degraded = degraded_lines(status, most_degraded);
  lines.insert(lines.end(), degraded.begin(), degraded.end());
  add_safety(lines, status);
  for (const api::ArmStatus& arm : status.arms) add_arm(lines, status, arm, glyphs);
  add_worlds(lines, status, glyphs);
  return lines;
}

const api::WorldStatus* world_of(const api::Status& status, const api::ArmStatus& arm) {
  const auto found = std::find_if(status.worlds.begin(), status.worlds.end(),
                                  [&](const auto& world) { return world.name == arm.world; });
  return found == status.worlds.end() ? nullptr : &*found;
}

std::string joined(const Lines& lines) {
  std::string out;
  for (const std::string& line : lines) {
    const std::size_t end = line.find_last_not_of(' ');
    out += line.substr(0, end == std::string::npos ? 0 : end + 1) + "\n";
  }
  return out;
}

}  // namespace

std::string render_status(const api::Status& status, Glyphs glyphs) {
  return joined(all_lines(status, glyphs, std::numeric_limits<std::size_t>::max()));
}

std::string render_watch(const api::Status& status, Glyphs glyphs, std::size_t rows) {
  Lines lines = all_lines(status, glyphs, kDegradedLinesOfAPicture);
  for (const api::ArmStatus& arm : status.arms) {
    const std::size_t room = rows > lines.size() + 1 ? rows - lines.size() - 1 : 0;
    const Lines map = finger_map(arm, world_of(status, arm), glyphs, room);
    lines.insert(lines.end(), map.begin(), map.end());
  }
  lines.resize(std::min(lines.size(), std::max<std::size_t>(rows, 2) - 1));
  return joined(lines);
}

std::string render_line(const api::Status& status) {
  Lines lines;
  for (const api::ArmStatus& arm : status.arms) {
    std::string line = fixed(status.uptime_s, 1) + " s " + plain(arm.name) + " " + plain(arm.state);
    for (const double component_m : arm.position_m)
      line += " " + signed_fixed(component_m * 1e3, 1);
    line += " mm " + fixed(norm(arm.force_newton), 2) + " N offset " +
            fixed(norm(arm.offset_m) * 1e3, 1) + " mm contacts " + std::to_string(arm.contacts);
    if (arm.is_in_contact) line += " touching";
    if (arm.felt.pressure_newton) {
      line += " pressure " + fixed(norm(*arm.felt.pressure_newton), 2) + " N";
    }
    if (!arm.faults.empty()) line += " FAULT " + plain(arm.faults[0].code);
    lines.push_back(std::move(line));
  }
  return joined(lines);
}

std::string render_report(const api::Status& status, Glyphs glyphs) {
  Lines lines;
  lines.push_back("session of " + fixed(status.uptime_s, 1) + " s");
  for (const std::string& sentence : status.degraded) add_plain(lines, "DEGRADED", sentence);
  for (const api::ArmStatus& arm : status.arms) {
    add_heading(lines, "arm " + plain(arm.name) + "  " + plain(arm.device));
    add(lines, "contacts", std::to_string(arm.contacts));
    add(lines, "peak force", fixed(arm.peak_force_newton, 2) + " N");
    add(lines, "offset",
        "peak " + fixed(arm.peak_offset_m * 1e3, 2) + " mm, at the end " +
            fixed(norm(arm.offset_m) * 1e3, 2) + " mm");
    for (const api::ServoStatus& servo : status.servos) {
      if (servo.arm == arm.name) add_servo(lines, servo, glyphs);
    }
    for (const api::LinkStatus& link : status.links) {
      if (link.arm == arm.name) add_link(lines, link, glyphs);
    }
    add_faults(lines, arm);
  }
  return joined(lines);
}

}  // namespace thimble::cli
