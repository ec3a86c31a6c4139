#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/doctor/facts.hpp"

// Texts of the kernel as values: proc(5), group(5) and the uevent files of sysfs. All total: what
// is missing or odd is empty. Thread: any. Not RT. Pure.
namespace thimble::doctor {

// Without the blanks and the line break around it.
[[nodiscard]] std::string trimmed(std::string_view text);
[[nodiscard]] std::vector<std::string> words_of(std::string_view text);
// The whole text as a number, or nothing.
[[nodiscard]] std::optional<std::int64_t> parse_integer(std::string_view text);

// The whole text as a number of at most four hexadecimal digits, as of USB's descriptors.
[[nodiscard]] std::optional<std::uint16_t> parse_hexadecimal(std::string_view text);

struct LimitRow {
  Limit soft;
  Limit hard;
};
// A row of /proc/PID/limits by its name there, such as "Max locked memory".
[[nodiscard]] std::optional<LimitRow> parse_limit(std::string_view limits, std::string_view name);

// User, groups and capabilities of /proc/PID/status; the rest of `process` is left alone.
void parse_status(std::string_view status, Process& process);

// The number of a group in /etc/group.
[[nodiscard]] std::optional<std::uint32_t> parse_group(std::string_view file,
                                                       std::string_view name);

// The numbers of the groups in /etc/group that list a user as their member.
[[nodiscard]] std::vector<std::uint32_t> parse_memberships(std::string_view file,
                                                           std::string_view user);

// The name of a user in /etc/passwd, and the group that a login has at once.
[[nodiscard]] std::string parse_user(std::string_view file, std::uint32_t number);
[[nodiscard]] std::optional<std::uint32_t> parse_primary_group(std::string_view file,
                                                               std::string_view user);

// The service of systemd in whose group a process is, by its /proc/PID/cgroup; a process of a
// login session is in none, though that session's user@UID.service is above it. In a service of
// a user's own manager it is that user@UID.service, from which the rights come.
[[nodiscard]] std::string parse_service(std::string_view cgroup);

struct HidIds {
  std::uint16_t vendor{0};
  std::uint16_t product{0};
  std::string serial_number;
  std::uint16_t bus{0};  // BUS_USB and others of linux/input.h
};
// HID_ID and HID_UNIQ of a HID device's uevent file; nothing when it has no HID_ID.
[[nodiscard]] std::optional<HidIds> parse_hid_ids(std::string_view uevent);

}  // namespace thimble::doctor
