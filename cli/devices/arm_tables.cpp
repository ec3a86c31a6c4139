#include "cli/devices/arm_tables.hpp"

#include <set>

#include "cli/text.hpp"

namespace thimble::devices_list {
namespace {

using cli::plain;

constexpr std::size_t kLineColumns = 80;
// What each amplifier of the open controllers has at least (docs/first-arm.md): too low weakens.
constexpr const char* kSafeCurrent = "3.0";
constexpr const char* kFirstTouch_newton = "1";

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char letter : plain(text)) {
    if (letter == '"' || letter == '\\') out += '\\';
    out += letter;
  }
  return out + '"';
}

std::string comment(const std::string& sentence) {
  std::string out;
  std::string lines = cli::wrap(plain(sentence), kLineColumns - 2, 0);
  for (std::size_t begin = 0; begin < lines.size();) {
    const std::size_t end = lines.find('\n', begin);
    out += "# " + lines.substr(begin, end - begin) + "\n";
    begin = end == std::string::npos ? lines.size() : end + 1;
  }
  return out;
}

// "right", "left", "arm-3", "arm-4" …: the first that is free, which is taken with that.
std::string next_name(std::set<std::string>& taken) {
  std::string name = "right";
  for (int number = 2; !taken.insert(name).second; ++number) {
    name = number == 2 ? "left" : "arm-" + std::to_string(number);
  }
  return name;
}

std::string lines_of_model(const Entry& entry) {
  std::string out = comment(
      "Which arm it drives, the controller cannot tell: take the # away "
      "from the one that it is.");
  for (const std::string& model : entry.models) out += "# model = " + quoted(model) + "\n";
  return out;
}

std::string lines_of_amplifier(const NeededKeys& keys) {
  if (!keys.is_too_low_harmless) {
    return comment("Full scale of its amplifiers, which you have to know.") +
           "# amplifier_max_a =\n";
  }
  return comment(
             "Full scale of its amplifiers, as its firmware was built; too low only weakens it.") +
         "amplifier_max_a = " + kSafeCurrent + "\n";
}

std::string table(const Entry& entry, const std::string& name, const std::string& world) {
  std::string out = "\n" + comment(entry.description);
  if (!entry.obstacle.empty()) out += comment("It cannot be used yet: " + entry.obstacle);
  out += "[[arm]]\nname = " + quoted(name) + "\ndevice = " + quoted(entry.address) + "\n";
  if (entry.keys.model) out += lines_of_model(entry);
  if (entry.keys.amplifier_max_a) out += lines_of_amplifier(entry.keys);
  if (entry.keys.firmware) {
    out += comment("Beside this file; docs/first-arm.md says where to get it.");
    out += "firmware = \"nvent_firmware.bin\"\n";
  }
  out += "world = " + quoted(world) + "\nactivate = false\n";
  if (!entry.keys.limits) return out;
  return out + "[arm.limits]\nforce_newton = " + kFirstTouch_newton + "\n";
}

}  // namespace

std::string arm_tables(const std::vector<Entry>& entries, const api::Status& status,
                       const std::string& daemon) {
  std::set<std::string> names;
  for (const api::ArmStatus& arm : status.arms) names.insert(arm.name);
  const std::string world = status.worlds.empty() ? "box" : status.worlds.front().name;
  std::string out = comment(daemon);
  const std::size_t before = out.size();
  for (const Entry& entry : entries) {
    if (entry.is_plugged_in_arm && entry.users.empty()) {
      out += table(entry, next_name(names), world);
    }
  }
  return out.size() > before ? out : out + comment("No arm is plugged in that nobody uses.");
}

}  // namespace thimble::devices_list
