#include "cli/devices/report.hpp"

#include <algorithm>
#include <boost/json.hpp>
#include <map>

#include "cli/text.hpp"
#include "daemon/api/json_text.hpp"

namespace thimble::devices_list {
namespace {

using cli::plain;

constexpr std::size_t kColumns = 80;
constexpr std::size_t kIndent = 4;

std::string below(const std::string& sentence) {
  return cli::wrap(plain(sentence), kColumns, kIndent);
}

std::string heading_of(const Entry& entry) {
  return entry.address + (entry.description.empty() ? "" : "  " + entry.description);
}

std::string list_of(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : ", ") + word;
  return all;
}

boost::json::array array_of(const std::vector<std::string>& words) {
  boost::json::array all;
  for (const std::string& word : words) all.emplace_back(plain(word));
  return all;
}

}  // namespace

std::string render(const std::vector<Entry>& entries, const std::string& daemon) {
  std::string out;
  const bool has_arm = std::any_of(entries.begin(), entries.end(),
                                   [](const Entry& entry) { return entry.is_plugged_in_arm; });
  if (!has_arm) out += "no arm is plugged in (thimble doctor)\n";
  std::map<std::string, std::string> told;  // what is needed, and at which address that stands
  for (const Entry& entry : entries) {
    out += cli::wrap(plain(heading_of(entry)), kColumns, 0);
    if (!entry.obstacle.empty()) out += below("cannot be used: " + entry.obstacle);
    if (!entry.needs.empty()) {
      const auto [first, is_new] = told.emplace(entry.needs, entry.address);
      out += below(is_new ? "can be used; a configuration must say more: " + entry.needs
                          : "can be used; a configuration must say more, as for " + first->second);
    }
    if (entry.obstacle.empty() && entry.needs.empty()) out += below("can be used");
    if (!entry.models.empty()) out += below("its arm.model: " + list_of(entry.models));
    if (!entry.users.empty()) out += below("in use by " + list_of(entry.users));
  }
  return out + cli::wrap(plain(daemon), kColumns, 0);
}

std::string to_json(const std::vector<Entry>& entries, const std::string& daemon) {
  boost::json::array devices;
  for (const Entry& entry : entries) {
    devices.push_back(boost::json::object{{"address", plain(entry.address)},
                                          {"description", plain(entry.description)},
                                          {"usable", entry.obstacle.empty()},
                                          {"obstacle", plain(entry.obstacle)},
                                          {"needs", plain(entry.needs)},
                                          {"models", array_of(entry.models)},
                                          {"users", array_of(entry.users)}});
  }
  return api::to_text(
      boost::json::object{{"daemon", plain(daemon)}, {"devices", std::move(devices)}});
}

}  // namespace thimble::devices_list
