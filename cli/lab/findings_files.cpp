#include "cli/lab/findings_files.hpp"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <boost/json.hpp>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "cli/file_text.hpp"

extern char** environ;  // NOLINT: what a child is given; posix_spawn asks for it

namespace thimble::lab_commands {
namespace {

namespace json = boost::json;

// The shortest that reads back as the same number.
std::string digits(double number) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number).ptr;
  return {buffer.data(), end};
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::string csv_cell(const lab::Cell& cell) {
  if (const std::string* text = std::get_if<std::string>(&cell)) return csv_field(*text);
  const double number = std::get<double>(cell);
  return std::isfinite(number) ? digits(number) : "";
}

json::value json_cell(const lab::Cell& cell) {
  if (const std::string* text = std::get_if<std::string>(&cell)) return json::value(*text);
  const double number = std::get<double>(cell);
  return std::isfinite(number) ? json::value(number) : json::value(nullptr);
}

json::object json_table(const lab::Table& table) {
  json::array columns;
  for (const lab::Column& column : table.columns) {
    columns.push_back(json::object{{"name", column.name}, {"unit", column.unit}});
  }
  json::array rows;
  for (const auto& row : table.rows) {
    json::array cells;
    for (const lab::Cell& cell : row) cells.push_back(json_cell(cell));
    rows.push_back(std::move(cells));
  }
  return {{"title", table.title}, {"columns", std::move(columns)}, {"rows", std::move(rows)}};
}

// Of gnuplot's, in single quotes: nothing in it means anything.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\n') continue;
    out += c;
    if (c == '\'') out += '\'';
  }
  return out + '\'';
}

// Colors that people with any eyes tell apart (Okabe and Ito, "Color universal design"), and black
// and gray; shapes of gnuplot's, so that a copy in gray tells them apart, too.
struct Look {
  const char* color;
  int shape;
};
constexpr std::array kLooks{Look{"#0072b2", 7},  Look{"#d55e00", 5},  Look{"#009e73", 9},
                            Look{"#cc79a7", 13}, Look{"#e69f00", 11}, Look{"#56b4e9", 6},
                            Look{"#000000", 4},  Look{"#808080", 8},  Look{"#7a5230", 12},
                            Look{"#6a3d9a", 10}, Look{"#a50026", 1},  Look{"#4d7c0f", 2}};

std::string style_of(const lab::Series& series, std::size_t place) {
  const std::size_t wanted = series.style > 0 ? static_cast<std::size_t>(series.style) - 1 : place;
  const Look& look = kLooks[wanted % kLooks.size()];
  const std::string color = std::string(" lc rgb '") + look.color + '\'';
  const std::string shape = " pt " + std::to_string(look.shape);
  if (series.mark == lab::Mark::Line) return "lines lw 1.8" + color;
  if (series.mark == lab::Mark::Dashed) return "lines lw 1.5 dt 2" + color;
  if (series.mark == lab::Mark::Points) return "points" + shape + " ps 1.2 lw 1.5" + color;
  return "linespoints" + shape + " ps 0.8 lw 1.5" + color;
}

std::string axis_text(const lab::Axis& axis, const char* letter) {
  std::string text = std::string("set ") + letter + "label " + quoted(axis.label) + '\n';
  if (axis.is_logarithmic) text += std::string("set logscale ") + letter + '\n';
  return text;
}

// Runs `gnuplot SCRIPT` in `folder`. Empty, or why there is no picture.
std::string draw(const std::string& folder, const std::string& script) {
  std::array<std::string, 2> words{"gnuplot", script};
  std::array<char*, 3> arguments{words[0].data(), words[1].data(), nullptr};
  posix_spawn_file_actions_t files;
  ::posix_spawn_file_actions_init(&files);
  ::posix_spawn_file_actions_addchdir_np(&files, folder.c_str());
  pid_t pid = 0;
  const int failed =
      ::posix_spawnp(&pid, words[0].c_str(), &files, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&files);
  if (failed != 0) return "there is no gnuplot (Debian: gnuplot-nox): no plots were drawn";
  int status = 0;
  if (::waitpid(pid, &status, 0) != pid || !WIFEXITED(status)) return "gnuplot was ended";
  return WEXITSTATUS(status) == 0 ? "" : "gnuplot refuses " + script;
}

Result<void> write_into(const std::string& folder, const std::string& name,
                        const std::string& content, Written& written) {
  const std::string file = folder + '/' + name;
  if (const auto done = cli::write_whole(file, content); !done) {
    return tl::unexpected(done.error().in(file));
  }
  written.files.push_back(file);
  return {};
}

bool is_there(const std::string& file) {
  std::error_code failed;
  const auto bytes = std::filesystem::file_size(file, failed);
  return !failed && bytes > 0;
}

// The pictures of the plot `name`; `why`: there are none, or empty, which gnuplot says on a full
// disk, too.
void note_pictures(const std::string& folder, const std::string& name, std::string why,
                   Written& written) {
  if (why.empty()) {
    for (const char* kind : {".svg", ".png"}) {
      std::string file = folder;
      file.append("/").append(name).append(kind);
      if (is_there(file)) {
        written.files.push_back(std::move(file));
      } else if (why.empty()) {
        why = "gnuplot did not draw " + name + kind;
      }
    }
  }
  if (why.empty()) return;
  // Each plot has the same reason where there is no gnuplot.
  if (written.not_drawn.find(why) != std::string::npos) return;
  written.not_drawn += (written.not_drawn.empty() ? "" : "; ") + why;
}

}  // namespace

std::string to_csv(const lab::Table& table) {
  std::string text;
  const char* comma = "";
  for (const lab::Column& column : table.columns) {
    const std::string unit = column.unit.empty() ? "" : " [" + column.unit + "]";
    text += std::exchange(comma, ",") + csv_field(column.name + unit);
  }
  text += '\n';
  for (const auto& row : table.rows) {
    comma = "";
    for (const lab::Cell& cell : row) text += std::exchange(comma, ",") + csv_cell(cell);
    text += '\n';
  }
  return text;
}

std::string to_json(const lab::Findings& findings) {
  json::object parameters;
  for (const lab::Parameter& parameter : findings.parameters) {
    parameters[parameter.name] =
        json::object{{"value", json_cell(parameter.value)}, {"unit", parameter.unit}};
  }
  json::object tables;
  for (const lab::Table& table : findings.tables) tables[table.name] = json_table(table);
  json::array criteria;
  for (const lab::Criterion& criterion : findings.criteria) {
    criteria.push_back(json::object{{"text", criterion.text}, {"is_met", criterion.is_met}});
  }
  json::array remarks;
  for (const std::string& remark : findings.remarks) remarks.push_back(json::value(remark));
  const json::object all{{"experiment", findings.experiment},   {"title", findings.title},
                         {"parameters", std::move(parameters)}, {"tables", std::move(tables)},
                         {"criteria", std::move(criteria)},     {"remarks", std::move(remarks)}};
  return json::serialize(all) + '\n';
}

std::string to_gnuplot(const lab::Plot& plot, const std::string& stem) {
  std::string text = "set encoding utf8\nset title " + quoted(plot.title) + " noenhanced\n" +
                     axis_text(plot.x, "x") + axis_text(plot.y, "y") +
                     "set key below Left reverse noenhanced samplen 3 maxrows 4 height 1\nset "
                     "grid\nset autoscale xfix\nset "
                     "datafile missing '?'\n";
  std::string drawn;
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    const lab::Series& series = plot.series[i];
    const std::string name = "$series" + std::to_string(i);
    text += name + " << EOD\n";
    for (const auto& [x, y] : series.points) {
      const bool is_there = std::isfinite(x) && std::isfinite(y);
      text += is_there ? digits(x) + ' ' + digits(y) + '\n' : "\n";
    }
    text += "EOD\n";
    drawn += (i == 0 ? "plot " : ", ") + name + " using 1:2 with " + style_of(series, i) +
             (series.label.empty() ? " notitle" : " title " + quoted(series.label));
  }
  text += "set terminal svg size 900,600 dynamic font 'sans,13'\nset output " +
          quoted(stem + ".svg") + '\n' + drawn +
          "\nset terminal pngcairo size 1350,900 font 'sans,15'\nset output " +
          quoted(stem + ".png") + '\n' + drawn + '\n';
  return text;
}

Result<void> make_folder(const std::string& folder) {
  std::error_code failed;
  const auto status = std::filesystem::status(folder, failed);
  if (std::filesystem::exists(status) && !std::filesystem::is_directory(status)) {
    return fail(Errc::InvalidArgument, folder + ": is there, and is no folder");
  }
  std::filesystem::create_directories(folder, failed);
  if (failed) return fail(Errc::System, folder + ": " + failed.message());
  if (::access(folder.c_str(), W_OK | X_OK) != 0) {
    return fail(Errc::System, folder + ": " + std::strerror(errno));
  }
  return {};
}

Result<Written> write_findings(const lab::Findings& findings, const std::string& folder) {
  if (const auto made = make_folder(folder); !made) return tl::unexpected(made.error());
  Written written;
  const std::string& stem = findings.experiment;
  if (auto done = write_into(folder, stem + ".json", to_json(findings), written); !done) {
    return tl::unexpected(done.error());
  }
  for (const lab::Table& table : findings.tables) {
    auto done = write_into(folder, stem + '-' + table.name + ".csv", to_csv(table), written);
    if (!done) return tl::unexpected(done.error());
  }
  for (const lab::Plot& plot : findings.plots) {
    const std::string name = stem + '-' + plot.name;
    auto done = write_into(folder, name + ".gp", to_gnuplot(plot, name), written);
    if (!done) return tl::unexpected(done.error());
    note_pictures(folder, name, draw(folder, name + ".gp"), written);
  }
  return written;
}

}  // namespace thimble::lab_commands
