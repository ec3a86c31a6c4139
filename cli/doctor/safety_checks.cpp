#include <algorithm>
#include <charconv>
#include <optional>
#include <string>

#include "cli/doctor/checks.hpp"
#include "cli/doctor/rights.hpp"

namespace thimble::doctor {
namespace {

constexpr const char* kWhyNeeded =
    "without all its safety lines the daemon keeps every arm stopped: none can be driven";
// "thimbled" says who it is when it takes a line; anybody may say so.
constexpr const char* kConsumer = "thimbled";

std::string labels_of(const std::vector<GpioChip>& chips) {
  std::string labels;
  for (const GpioChip& chip : chips) labels += (labels.empty() ? "'" : ", '") + chip.label + "'";
  return labels.empty() ? "none" : labels;
}

std::vector<const GpioChip*> safety_chips(const Facts& facts) {
  std::vector<const GpioChip*> chips;
  for (const GpioChip& chip : facts.gpio_chips) {
    if (facts.safety && chip.label == facts.safety->chip) chips.push_back(&chip);
  }
  return chips;
}

Verdict unread_chips(const Facts& facts, const std::string& chip) {
  std::string nodes;
  for (const std::string& node : facts.unread_gpio_chips) nodes += " " + node;
  return {
      Level::Warn,
      "safety-chip",
      "no GPIO chip of the label '" + chip + "' was found, but" + nodes + " could not be looked at",
      kWhyNeeded,
      "",
      "root may look at them all: ask as root, with the same --config",
      "sudo gpiodetect"};
}

Verdict missing_chip(const Facts& facts, const std::string& chip) {
  if (!facts.unread_gpio_chips.empty()) return unread_chips(facts, chip);
  Verdict verdict{
      Level::Wrong,
      "safety-chip",
      "there is no GPIO chip of the label '" + chip + "'; there is: " + labels_of(facts.gpio_chips),
      kWhyNeeded,
      "",
      "plug its adapter in, or correct safety.chip: labels are in brackets there",
      "gpiodetect"};
  // Where the kernel has not loaded the driver by itself: docs/safety-wiring.md recommends the
  // chip.
  if (chip == "cp2112_gpio") verdict.command = "sudo modprobe hid-cp2112";
  return verdict;
}

// What /sys calls the device, or, of HID, all devices with its ids: their numbers are counted on.
std::string lasting_name(const std::string& device) {
  // "0003:10C4:EA90.0007"; a place on PCI, "0000:00:1f.0", lasts as it is.
  constexpr std::size_t kBusEnd = 4;
  constexpr std::size_t kProductEnd = 14;
  const bool is_hid = device.size() == 19 && device[kBusEnd] == ':' && device[9] == ':' &&
                      device[kProductEnd] == '.';
  return is_hid ? "*" + device.substr(kBusEnd, kProductEnd - kBusEnd) + ".*" : device;
}

Verdict closed_chip(const Facts& facts, const GpioChip& chip) {
  const std::string& node = chip.node.path;
  const std::string name = node.substr(node.rfind('/') + 1);
  const std::string match =
      chip.device.empty() ? "KERNEL==\"" + name : "KERNELS==\"" + lasting_name(chip.device);
  // A rule that names a group which is not there gives the node to the group root.
  const bool is_group_missing = !facts.thimble_group && facts.unknown_accounts.empty();
  return {Level::Wrong,
          "safety-chip",
          node + " may not be read and written by the daemon",
          kWhyNeeded,
          std::string(is_group_missing ? "sudo addgroup --system thimble && " : "") +
              "echo 'SUBSYSTEM==\"gpio\", " + match +
              "\", GROUP=\"thimble\", MODE=\"0660\"' | sudo tee "
              "/etc/udev/rules.d/99-thimble-gpio.rules && sudo udevadm control --reload && "
              "sudo udevadm trigger --settle " +
              node,
          "the daemon must run in the group 'thimble'"};
}

std::optional<std::size_t> number_in(const std::string& line) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), number);
  if (error != std::errc{} || end != line.data() + line.size()) return std::nullopt;
  return number;
}

// As the daemon finds it: by its number, else by its name.
const linux::GpioLineInfo* find_line(const GpioChip& chip, const std::string& line) {
  const std::optional<std::size_t> number = number_in(line);
  if (number) return *number < chip.lines.size() ? &chip.lines[*number] : nullptr;
  const auto found = std::find_if(chip.lines.begin(), chip.lines.end(),
                                  [&](const linux::GpioLineInfo& one) { return one.name == line; });
  return found == chip.lines.end() ? nullptr : &*found;
}

// Lines have no owner that could be asked for: their chip's node has.
bool is_the_daemons(const Facts& facts, const GpioChip& chip, const linux::GpioLineInfo& line) {
  if (line.consumer != kConsumer || facts.process.known_by == KnownBy::Nothing) return false;
  return chip.is_held_by_the_daemon || (chip.holders.empty() && facts.hidden_processes > 0);
}

Verdict taken_line(const Facts& facts, const GpioChip& chip, const std::string& check,
                   const std::string& finding) {
  Verdict verdict{Level::Wrong,
                  check,
                  finding,
                  kWhyNeeded,
                  "",
                  "a driver of the kernel has it, or its export in /sys/class/gpio: choose another "
                  "line, or take that driver's away",
                  "gpioinfo " + chip.label};
  if (facts.hidden_processes > 0) {
    verdict.advice = "root may see which program that is: ask as root, with the same --config";
    verdict.look_with = "sudo fuser -v " + chip.node.path;
  }
  if (chip.holders.empty()) return verdict;
  std::string pids;
  for (const NamedProcess& holder : chip.holders) {
    verdict.finding += "; '" + holder.name + "' (" +
                       process_of_user(holder.pid, holder.user, holder.user_name) +
                       ") has the chip open";
    pids += " " + std::to_string(holder.pid);
  }
  verdict.command = "sudo kill" + pids;
  verdict.advice =
      "look first what it belongs to: a service comes back, so stop and disable it with systemctl";
  verdict.look_with = "systemctl status" + pids;
  return verdict;
}

Verdict check_safety_chip(const Facts& facts, const config::SafetyConfig& safety) {
  if (safety.is_simulated())
    return all_well("safety-chip", "the safety lines are simulated, as all arms are");
  const std::vector<const GpioChip*> chips = safety_chips(facts);
  if (chips.empty()) return missing_chip(facts, safety.chip);
  if (chips.size() > 1) {
    return {Level::Wrong,
            "safety-chip",
            chips[0]->node.path + " and " + chips[1]->node.path + " both have the label '" +
                safety.chip + "'",
            "which of them has the emergency stop cannot be guessed; the daemon takes neither and "
            "keeps every arm stopped",
            "",
            "unplug one of them",
            "gpiodetect"};
  }
  if (!may(facts.process, chips[0]->node, kRead | kWrite)) return closed_chip(facts, *chips[0]);
  return all_well("safety-chip", chips[0]->node.path + " is '" + safety.chip +
                                     "' and may be opened by the daemon");
}

Verdict check_safety_line(const Facts& facts, const GpioChip& chip, const std::string& purpose,
                          const std::string& line) {
  const std::string check = "safety-line " + line;
  const linux::GpioLineInfo* const found = find_line(chip, line);
  if (found == nullptr) {
    return {Level::Wrong,
            check,
            "'" + chip.label + "' has no line '" + line + "' for " + purpose + "; it has " +
                std::to_string(chip.lines.size()) + ", numbered from 0",
            kWhyNeeded,
            "",
            "correct " + purpose + ": lines are there by number and by name",
            "gpioinfo " + chip.label};
  }
  if (!found->is_taken) return all_well(check, "it is there for " + purpose + ", nobody has it");
  if (is_the_daemons(facts, chip, *found)) {
    return all_well(check, "it is there for " + purpose + ", thimbled has it");
  }
  const std::string who = found->consumer.empty() ? "somebody" : "'" + found->consumer + "'";
  return taken_line(facts, chip, check, "the line for " + purpose + " is taken by " + who);
}

}  // namespace

std::vector<Verdict> check_safety(const Facts& facts) {
  if (!facts.safety) return {};
  const config::SafetyConfig& safety = *facts.safety;
  std::vector<Verdict> verdicts{check_safety_chip(facts, safety)};
  const std::vector<const GpioChip*> chips = safety_chips(facts);
  if (chips.size() != 1) return verdicts;
  const auto check = [&](const char* purpose, const std::optional<std::string>& line) {
    if (line) verdicts.push_back(check_safety_line(facts, *chips[0], purpose, *line));
  };
  for (const std::string& line : safety.estop) check("safety.estop", line);
  check("safety.deadman", safety.deadman);
  check("safety.enable", safety.enable);
  check("safety.lamp", safety.lamp);
  return verdicts;
}

}  // namespace thimble::doctor
