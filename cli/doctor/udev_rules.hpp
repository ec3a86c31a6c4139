#pragma once

#include <string>
#include <vector>

#include "cli/doctor/facts.hpp"

namespace thimble::doctor {

// A file of udev(7) for /etc/udev/rules.d.
struct UdevRules {
  std::string file;  // its name alone; udev takes the files of all folders by name, in byte order
  std::string line;
  bool operator==(const UdevRules&) const = default;
};

// What gives every node of the device to root and the group 'thimble' and to nobody else, whatever
// rules of other files assign: two files, because an assignment with ":=" cannot be undone by one
// behind it, and the tag "uaccess" be taken away only once it was given
// (docs/decisions/0242-rules-that-win.md). Thread: any. Not RT. Pure.
[[nodiscard]] std::vector<UdevRules> closing_rules(const Controller& controller);

// For a shell: writes them and has them applied to what is plugged in.
[[nodiscard]] std::string closing_command(const Controller& controller);

// For a shell: lists the files of rules that may speak of the device; changes nothing.
[[nodiscard]] std::string rules_that_speak_of(const Controller& controller);

}  // namespace thimble::doctor
