#include <algorithm>
#include <string>
#include <string_view>

#include "cli/doctor/checks.hpp"
#include "cli/doctor/rights.hpp"

namespace thimble::doctor {
namespace {

std::string subject(const Process& process) {
  if (process.pid == 0) return "a thimbled started here";
  return "thimbled (" + process_of_user(process.pid, process.user, process.user_name) + ")";
}

// One word of a shell, whatever it holds: names of units and users come from outside.
std::string shell_word(const std::string& text) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789@:._-";
  if (!text.empty() && text.find_first_not_of(kPlain) == std::string::npos) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

// The account whose rights are too small. One that is not in /etc/passwd may be known elsewhere.
std::string account(const Process& process) {
  if (process.pid == 0) return "\"$USER\"";
  if (process.user_name.empty()) return "\"$(id -nu " + std::to_string(process.user) + ")\"";
  return shell_word(process.user_name);
}

// A user's own manager is not started anew: all that its user runs would end.
bool is_users_manager(const Process& process) { return process.unit.starts_with("user@"); }

std::string restart_command(const Process& process) {
  if (process.is_a_strangers || process.unit.empty() || is_users_manager(process)) return "";
  return "sudo systemctl restart " + shell_word(process.unit);
}

// systemd.unit(5): a file below NAME.service.d adds to the unit; one for each check, so that none
// takes another's place.
std::string unit_command(const Process& process, const std::string& check,
                         const std::string& setting) {
  const std::string unit = shell_word(process.unit);
  const std::string folder = "/etc/systemd/system/" + unit + ".d";
  const std::string restart = restart_command(process);
  return "sudo mkdir -p " + folder + " && printf '[Service]\\n" + setting + "\\n' | sudo tee " +
         folder + "/thimble-" + check + ".conf && sudo systemctl daemon-reload" +
         (restart.empty() ? "" : " && " + restart);
}

// limits.conf(5) is read at a login (pam_limits), which no service of the system goes through. One
// file for each check: typed twice, the command says the same once.
std::string limit_command(const Process& process, const std::string& check, const std::string& row,
                          const std::string& setting) {
  if (process.is_a_strangers) return "";
  if (!process.unit.empty()) return unit_command(process, check, setting);
  return "echo '@thimble - " + row + "' | sudo tee /etc/security/limits.d/thimble-" + check +
         ".conf";
}

std::string membership_command(const Process& process) {
  if (process.is_a_strangers) return "";
  if (!process.unit.empty()) return unit_command(process, "group", "SupplementaryGroups=thimble");
  return "sudo adduser " + account(process) + " thimble";
}

// Where there may be no command.
std::string look(const Process& process) {
  return process.is_a_strangers ? "ps -o user,lstart,args -p " + std::to_string(process.pid) : "";
}

std::string again(const Process& process, const std::string& setting) {
  if (process.is_a_strangers) {
    return "anybody may start that program, so no command gives this one a right: ask as its user, "
           "or name its socket with --socket, if it is the one that is meant";
  }
  if (is_users_manager(process)) {
    return "counts once " + process.unit +
           " starts anew: when its user has logged out everywhere, at the latest with the machine";
  }
  if (!process.unit.empty()) {
    return process.unit + " then starts anew: what runs in it ends, its arms lose their force";
  }
  if (process.pid != 0) return "then log in again as that user and start thimbled anew";
  return "then log in again; a unit of systemd needs " + setting + " instead";
}

Verdict unknown_group(const Facts& facts, Verdict verdict) {
  verdict.level = Level::Warn;
  verdict.finding = "the group 'thimble' could not be looked up: " + facts.unknown_accounts;
  verdict.advice = "mend the source of accounts that nsswitch.conf names, then ask again";
  verdict.look_with = "getent group thimble";
  return verdict;
}

}  // namespace

Verdict check_daemon(const Facts& facts) {
  const Process& process = facts.process;
  Verdict verdict = all_well("daemon", "none is known to run: below are the rights of who asks");
  if (process.known_by == KnownBy::Socket) {
    verdict.finding = subject(process) + " listens at the socket";
  } else if (process.known_by == KnownBy::Program) {
    verdict.finding = subject(process) + " runs the thimbled that belongs to this thimble";
  }
  if (facts.daemon_trouble.empty() && facts.namesakes.empty()) return verdict;
  verdict.level = Level::Warn;
  if (!facts.daemon_trouble.empty()) verdict.finding += "; " + facts.daemon_trouble;
  for (const NamedProcess& other : facts.namesakes) {
    verdict.finding += "; " + process_of_user(other.pid, other.user, other.user_name) +
                       " calls itself 'thimbled', and nothing shows that it is";
  }
  verdict.reason =
      "a program takes what name it likes: of one that is not known to be the daemon the rights "
      "are "
      "not looked at, and no command is given that grants it any";
  verdict.advice = "root may see more; --socket names the socket of a daemon that is elsewhere";
  verdict.look_with = "sudo thimble doctor";
  return verdict;
}

Verdict check_group(const Facts& facts) {
  const Process& process = facts.process;
  Verdict verdict{facts.controllers.empty() ? Level::Warn : Level::Wrong,
                  "group",
                  "",
                  "device nodes of arms belong to that group: who is in it can go around the force "
                  "limit, and nobody else may; the limits below name it, too",
                  "",
                  again(process, "SupplementaryGroups=thimble"),
                  look(process)};
  if (!facts.thimble_group) {
    if (!facts.unknown_accounts.empty()) return unknown_group(facts, verdict);
    verdict.finding = "there is no group 'thimble'";
    verdict.command = "sudo addgroup --system thimble";
    if (!process.is_a_strangers && !has_capability(process, kCapDacOverride)) {
      verdict.command += " && " + membership_command(process);
    }
    return verdict;
  }
  if (is_in_group(process, *facts.thimble_group)) {
    return all_well("group", subject(process) + " is in the group 'thimble'");
  }
  if (has_capability(process, kCapDacOverride)) {
    return all_well("group", subject(process) + " may open every device");
  }
  verdict.finding = subject(process) + " is not in the group 'thimble'";
  const auto& login = process.login_groups;
  if (std::find(login.begin(), login.end(), *facts.thimble_group) == login.end()) {
    verdict.command = membership_command(process);
    return verdict;
  }
  verdict.finding += ", though its user is by now";
  verdict.command = restart_command(process);
  if (verdict.command.empty()) verdict.look_with = "id " + account(process);
  return verdict;
}

Verdict check_rtprio(const Facts& facts) {
  const Process& process = facts.process;
  const int wanted = facts.servo.priority;
  const bool is_allowed =
      has_capability(process, kCapSysNice) ||
      (process.rtprio && (process.rtprio->is_unlimited ||
                          process.rtprio->value >= static_cast<std::uint64_t>(wanted)));
  if (is_allowed) {
    return all_well("rtprio",
                    subject(process) + " may take real-time priority " + std::to_string(wanted));
  }
  const std::string now =
      process.rtprio ? std::to_string(process.rtprio->value) : std::string("not known");
  const std::string setting = "LimitRTPRIO=" + std::to_string(wanted);
  return {Level::Wrong,
          "rtprio",
          subject(process) + " may not take real-time priority " + std::to_string(wanted) +
              " (limit: " + now + ")",
          "every other program then delays the servo; with realtime = \"required\" it does not "
          "start at all",
          limit_command(process, "rtprio", "rtprio " + std::to_string(wanted), setting),
          again(process, setting),
          look(process)};
}

Verdict check_memlock(const Facts& facts) {
  const Process& process = facts.process;
  if (has_capability(process, kCapIpcLock) || (process.memlock && process.memlock->is_unlimited)) {
    return all_well("memlock", subject(process) + " may lock its memory");
  }
  const std::string now = process.memlock ? std::to_string(process.memlock->value / 1024) + " KiB"
                                          : std::string("not known");
  return {Level::Wrong,
          "memlock",
          subject(process) + " may not lock all its memory (limit: " + now + ")",
          "memory that is paged out stops the servo until the disk has answered",
          limit_command(process, "memlock", "memlock unlimited", "LimitMEMLOCK=infinity"),
          again(process, "LimitMEMLOCK=infinity"),
          look(process)};
}

Verdict check_dma_latency(const Facts& facts) {
  const Node& node = facts.dma_latency;
  const bool is_sleepless = facts.idle_driver.empty() || facts.idle_driver == "none";
  Verdict verdict{Level::Warn,
                  "idle-states",
                  subject(facts.process) + " may not write " + node.path,
                  "a CPU in deep sleep answers USB and timers up to a fraction of a millisecond "
                  "late",
                  "",
                  ""};
  if (!node.is_there && is_sleepless && !facts.cpus.empty()) {
    return all_well("idle-states", "this kernel puts no CPU into deep sleep");
  }
  if (!node.is_there) {
    verdict.finding = "there is no " + node.path;
    verdict.advice = "a container must be given it: --device " + node.path +
                     "; else the kernel parameters processor.max_cstate=1 and "
                     "intel_idle.max_cstate=1 do the same from the next start on";
    verdict.look_with = "cat /sys/devices/system/cpu/cpuidle/current_driver";
    return verdict;
  }
  if (may(facts.process, node, kWrite)) {
    return all_well("idle-states", subject(facts.process) + " may keep the CPUs out of deep sleep");
  }
  // A rule that names a group which is not there gives the node to the group root.
  const bool is_group_missing = !facts.thimble_group && facts.unknown_accounts.empty();
  verdict.command =
      std::string(is_group_missing ? "sudo addgroup --system thimble && " : "") +
      "echo 'KERNEL==\"cpu_dma_latency\", GROUP=\"thimble\", MODE=\"0660\"' | sudo tee "
      "/etc/udev/rules.d/99-thimble-latency.rules && sudo udevadm control --reload && "
      "sudo udevadm trigger --settle /dev/cpu_dma_latency";
  return verdict;
}

}  // namespace thimble::doctor
