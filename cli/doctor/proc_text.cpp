#include "cli/doctor/proc_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>

namespace thimble::doctor {
namespace {

constexpr std::string_view kBlank = " \t\r\n";

std::string_view trim(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlank) - begin + 1);
}

template <class Number>
std::optional<Number> number(std::string_view text, int base = 10) {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value, base);
  if (error != std::errc() || stopped != end || text.empty()) return std::nullopt;
  return value;
}

// Takes the next line off `text`.
std::string_view next_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return line;
}

// What follows `key` in the line that begins with it.
std::string_view value_of(std::string_view text, std::string_view key) {
  while (!text.empty()) {
    const std::string_view line = next_line(text);
    if (line.starts_with(key)) return trim(line.substr(key.size()));
  }
  return {};
}

// The first `Count` fields of a line, the last with whatever follows it; nothing when there are
// fewer.
template <std::size_t Count>
std::optional<std::array<std::string_view, Count>> fields(std::string_view line, char separator) {
  std::array<std::string_view, Count> out;
  for (std::size_t i = 0; i + 1 < Count; ++i) {
    const std::size_t end = line.find(separator);
    if (end == std::string_view::npos) return std::nullopt;
    out[i] = line.substr(0, end);
    line.remove_prefix(end + 1);
  }
  out[Count - 1] = line;
  return out;
}

// Of names with commas between them.
bool is_in_list(std::string_view list, std::string_view name) {
  list = trim(list);
  while (!list.empty()) {
    const std::size_t end = std::min(list.find(','), list.size());
    if (list.substr(0, end) == name) return true;
    list.remove_prefix(std::min(end + 1, list.size()));
  }
  return false;
}

std::optional<Limit> parse_limit_word(std::string_view word) {
  if (word == "unlimited") return Limit{true, 0};
  const auto value = number<std::uint64_t>(word);
  if (!value) return std::nullopt;
  return Limit{false, *value};
}

// Of the path below the root of the control groups. Only its last unit counts.
std::string service_of(std::string_view path) {
  std::string manager;
  std::string service;
  while (!path.empty()) {
    const std::size_t size = std::min(path.find('/'), path.size());
    const std::string name(path.substr(0, size));
    path.remove_prefix(std::min(size + 1, path.size()));
    if (name.ends_with(".scope")) service.clear();
    if (!name.ends_with(".service") || name == ".service") continue;
    service = name;
    if (name.starts_with("user@")) manager = name;
  }
  return service.empty() || manager.empty() ? service : manager;
}

}  // namespace

std::string trimmed(std::string_view text) { return std::string(trim(text)); }

std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> words;
  for (text = trim(text); !text.empty(); text = trim(text)) {
    const std::size_t size = std::min(text.find_first_of(kBlank), text.size());
    words.emplace_back(text.substr(0, size));
    text.remove_prefix(size);
  }
  return words;
}

std::optional<std::int64_t> parse_integer(std::string_view text) {
  return number<std::int64_t>(trim(text));
}

std::optional<std::uint16_t> parse_hexadecimal(std::string_view text) {
  return number<std::uint16_t>(trim(text), 16);
}

std::optional<LimitRow> parse_limit(std::string_view limits, std::string_view name) {
  const std::vector<std::string> words = words_of(value_of(limits, name));
  if (words.size() < 2) return std::nullopt;
  const auto soft = parse_limit_word(words[0]);
  const auto hard = parse_limit_word(words[1]);
  if (!soft || !hard) return std::nullopt;
  return LimitRow{*soft, *hard};
}

void parse_status(std::string_view status, Process& process) {
  // Real, effective, saved, file system: the effective one counts.
  const std::vector<std::string> users = words_of(value_of(status, "Uid:"));
  if (users.size() > 1) process.user = number<std::uint32_t>(users[1]).value_or(process.user);
  const std::vector<std::string> primary = words_of(value_of(status, "Gid:"));
  std::vector<std::string> groups = words_of(value_of(status, "Groups:"));
  if (primary.size() > 1) groups.push_back(primary[1]);
  for (const std::string& word : groups) {
    if (const auto group = number<std::uint32_t>(word)) process.groups.push_back(*group);
  }
  process.capabilities = number<std::uint64_t>(value_of(status, "CapEff:"), 16).value_or(0);
}

std::optional<std::uint32_t> parse_group(std::string_view file, std::string_view name) {
  while (!file.empty()) {
    const auto field = fields<4>(next_line(file), ':');  // name:password:number:members
    if (!field || (*field)[0] != name) continue;
    return number<std::uint32_t>((*field)[2]);
  }
  return std::nullopt;
}

std::vector<std::uint32_t> parse_memberships(std::string_view file, std::string_view user) {
  std::vector<std::uint32_t> groups;
  while (!file.empty()) {
    const auto field = fields<4>(next_line(file), ':');
    if (!field || !is_in_list((*field)[3], user)) continue;
    if (const auto group = number<std::uint32_t>((*field)[2])) groups.push_back(*group);
  }
  return groups;
}

std::string parse_user(std::string_view file, std::uint32_t number_wanted) {
  while (!file.empty()) {
    const auto field = fields<4>(next_line(file), ':');  // name:password:number:group:…
    if (!field || (*field)[0].empty()) continue;
    if (number<std::uint32_t>((*field)[2]) == number_wanted) return std::string((*field)[0]);
  }
  return "";
}

std::optional<std::uint32_t> parse_primary_group(std::string_view file, std::string_view user) {
  while (!file.empty()) {
    const auto field = fields<5>(next_line(file), ':');
    if (field && (*field)[0] == user) return number<std::uint32_t>((*field)[3]);
  }
  return std::nullopt;
}

std::string parse_service(std::string_view cgroup) {
  while (!cgroup.empty()) {
    std::string_view path = next_line(cgroup);  // number:controllers:path
    path.remove_prefix(std::min(path.find(':'), path.size()));
    if (!path.starts_with("::/") && !path.starts_with(":name=systemd:/")) continue;
    path.remove_prefix(path.find('/') + 1);
    std::string service = service_of(path);
    if (!service.empty()) return service;
  }
  return "";
}

std::optional<HidIds> parse_hid_ids(std::string_view uevent) {
  // HID_ID=BUS:VENDOR:PRODUCT, hexadecimal of 4, 8 and 8 digits.
  const std::string_view id = value_of(uevent, "HID_ID=");
  const std::size_t first = id.find(':');
  const std::size_t second = id.rfind(':');
  if (first == std::string_view::npos || second == first) return std::nullopt;
  const auto bus = number<std::uint16_t>(id.substr(0, first), 16);
  const auto vendor = number<std::uint32_t>(id.substr(first + 1, second - first - 1), 16);
  const auto product = number<std::uint32_t>(id.substr(second + 1), 16);
  if (!bus || !vendor || !product || *vendor > 0xFFFF || *product > 0xFFFF) return std::nullopt;
  return HidIds{static_cast<std::uint16_t>(*vendor), static_cast<std::uint16_t>(*product),
                std::string(value_of(uevent, "HID_UNIQ=")), *bus};
}

}  // namespace thimble::doctor
