#pragma once

#include <fnmatch.h>

#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace thimble::doctor {

// As much of udev(7) as rules about the rights of a node need: how keys match, which assignment
// counts, and what the tag "uaccess" does in 73-seat-late.rules.

// A device and those it hangs on, itself first: KERNEL, SUBSYSTEM and ATTR{…} of each.
using UdevDevice = std::vector<std::map<std::string, std::string>>;
// By name, in the order in which udev reads them.
using UdevFiles = std::map<std::string, std::vector<std::string>>;

struct UdevNode {
  std::map<std::string, std::string> keys{{"OWNER", "root"}, {"GROUP", "root"}, {"MODE", "0600"}};
  std::set<std::string> final_keys;
  std::set<std::string> tags;
  bool is_open_to_the_seat{false};
};

struct UdevToken {
  std::string key;
  std::string op;
  std::string value;
};

inline std::vector<UdevToken> udev_tokens(const std::string& line) {
  static const std::regex kToken(R"re(([A-Z]+(?:\{[^}]*\})?)(==|\+=|-=|:=|=)"([^"]*)")re");
  std::vector<UdevToken> tokens;
  for (std::sregex_iterator i(line.begin(), line.end(), kToken), end; i != end; ++i) {
    tokens.push_back({(*i)[1], (*i)[2], (*i)[3]});
  }
  return tokens;
}

inline bool udev_matches(const std::map<std::string, std::string>& device, const std::string& key,
                         const std::string& pattern) {
  const auto found = device.find(key);
  return found != device.end() && ::fnmatch(pattern.c_str(), found->second.c_str(), 0) == 0;
}

// KERNELS, SUBSYSTEMS and ATTRS{…} have to be all of one and the same device.
inline bool udev_line_matches(const std::vector<UdevToken>& tokens, const UdevDevice& device) {
  bool is_any = false;
  for (const auto& parent : device) {
    bool is_it = true;
    for (const UdevToken& token : tokens) {
      if (token.op != "==") continue;
      const std::size_t s = token.key.find("S{") != std::string::npos ? token.key.find("S{")
                            : token.key.ends_with("S")                ? token.key.size() - 1
                                                                      : std::string::npos;
      std::string key = token.key;
      if (s == std::string::npos) {
        is_it = is_it && udev_matches(device.front(), key, token.value);
      } else {
        is_it = is_it && udev_matches(parent, key.erase(s, 1), token.value);
      }
    }
    is_any = is_any || is_it;
  }
  return is_any;
}

inline void udev_assign(const UdevToken& token, UdevNode& node) {
  if (token.key == "TAG") {
    // "-=" only says that the tag is no longer current; to rules it still matches (udev 247 on).
    if (token.op == "=") node.tags.clear();
    if (token.op != "-=") node.tags.insert(token.value);
  }
  if (!node.keys.contains(token.key) || node.final_keys.contains(token.key)) return;
  node.keys[token.key] = token.value;
  if (token.op == ":=") node.final_keys.insert(token.key);
}

inline UdevNode udev_apply(UdevFiles files, const UdevDevice& device) {
  UdevNode node;
  files["73-seat-late.rules"];
  for (const auto& [name, lines] : files) {
    if (name == "73-seat-late.rules") node.is_open_to_the_seat = node.tags.contains("uaccess");
    for (const std::string& line : lines) {
      const auto tokens = udev_tokens(line);
      if (!udev_line_matches(tokens, device)) continue;
      for (const UdevToken& token : tokens) {
        if (token.op != "==") udev_assign(token, node);
      }
    }
  }
  return node;
}

}  // namespace thimble::doctor
