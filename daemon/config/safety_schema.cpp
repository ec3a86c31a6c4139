#include <algorithm>
#include <array>
#include <optional>

#include "daemon/config/schema.hpp"

namespace thimble::config {
namespace {

constexpr std::array<Choice<ClosedLevel>, 2> kLevels{{
    {"low", ClosedLevel::Low},
    {"high", ClosedLevel::High},
}};
constexpr std::array<Choice<PullResistor>, 2> kPulls{{
    {"internal", PullResistor::Internal},
    {"external", PullResistor::External},
}};
constexpr std::size_t kMaxLineNameBytes = 31;  // of a label or a line: GPIO_MAX_NAME_SIZE, Linux
constexpr std::size_t kMaxEstopChannels = 2;   // the safety chain compares two

bool is_good_name(const std::string& name) {
  const auto is_printable = [](char c) { return c >= ' ' && c <= '~'; };
  return name.size() <= kMaxLineNameBytes && std::all_of(name.begin(), name.end(), is_printable);
}

void check_name(TableReader& reader, std::string_view key, const std::string& name) {
  if (is_good_name(name)) return;
  reader.object(key,
                "expected up to 31 characters as gpioinfo shows them, found " + in_quotes(name));
}

// The label may have a '/', where the kernel makes it of a path of the device tree; but none is of
// a node.
void check_chip(TableReader& reader, const SafetyConfig& safety) {
  check_name(reader, "chip", safety.chip);
  if (!safety.chip.starts_with("/dev/")) return;
  reader.object("chip",
                "expected the label of a GPIO chip, as gpiodetect shows it in brackets: the number "
                "of its node may change; found " +
                    in_quotes(safety.chip));
}

// Of a real chip only the kernel knows which there are.
void check_place(TableReader& reader, std::string_view key, const std::string& line) {
  const bool is_there =
      line.size() == 1 && line[0] >= '0' && line[0] < '0' + static_cast<char>(kSimulatedLines);
  if (is_there) return;
  reader.object(key, "expected a line from \"0\" to \"" + std::to_string(kSimulatedLines - 1) +
                         "\" of a simulated chip, found " + in_quotes(line));
}

// One line serves one purpose.
void check_lines(TableReader& reader, const SafetyConfig& safety) {
  std::vector<std::string> taken;
  const auto take = [&](std::string_view key, const std::string& line) {
    check_name(reader, key, line);
    if (safety.is_simulated()) check_place(reader, key, line);
    if (std::find(taken.begin(), taken.end(), line) != taken.end()) {
      reader.object(key, "expected a line of its own, found " + in_quotes(line) + " again");
    }
    taken.push_back(line);
  };
  for (const std::string& line : safety.estop) take("estop", line);
  if (safety.deadman) take("deadman", *safety.deadman);
  if (safety.enable) take("enable", *safety.enable);
  if (safety.lamp) take("lamp", *safety.lamp);
}

}  // namespace

Entry<SafetyConfig> read_safety(TableReader reader) {
  SafetyConfig out;
  if (reader.is_present()) {
    reader.require("chip", "the label of a GPIO chip");
    reader.require("estop", "one line, or two");
  }
  reader.read("chip", out.chip);
  const bool has_estop = reader.read("estop", kMaxEstopChannels, out.estop);
  if (has_estop && out.estop.empty()) {
    reader.reject("estop", "expected one line, or two of the same button, found none");
  }
  reader.read("deadman", out.deadman);
  reader.read("enable", out.enable);
  reader.read("lamp", out.lamp);
  reader.read("closed_level", std::span<const Choice<ClosedLevel>>(kLevels), out.closed_level);
  reader.read("pull", std::span<const Choice<PullResistor>>(kPulls), out.pull);
  check_chip(reader, out);
  check_lines(reader, out);
  reader.finish();
  return {std::move(reader), std::move(out)};
}

void check_real_arms(Entry<SafetyConfig>& safety, const std::vector<Entry<ArmConfig>>& arms) {
  if (!safety.value.is_simulated()) return;
  // One that a simulated arm stands in for is real when it comes.
  const auto real = std::find_if(arms.begin(), arms.end(), [](const auto& entry) {
    return !entry.value.device.empty() && !entry.value.device.starts_with("sim:");
  });
  if (real == arms.end()) return;
  safety.reader.object(
      "chip",
      "expected the label of a GPIO chip, as gpiodetect shows it in brackets, since arm '" +
          real->value.name +
          "' is a real one: nobody presses a simulated emergency stop, so nobody could "
          "stop the arm; build what docs/safety-wiring.md says, or take [safety] out; found " +
          in_quotes(safety.value.chip));
}

}  // namespace thimble::config
