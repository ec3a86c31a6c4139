#include <string>

#include "cli/doctor/checks.hpp"
#include "cli/doctor/rights.hpp"
#include "daemon/config/config.hpp"

namespace thimble::doctor {
namespace {

std::string subject(const Process& process) {
  return process.pid == 0 ? "a thimbled started here"
                          : "thimbled (process " + std::to_string(process.pid) + ")";
}

std::string again(const Process& process) {
  return process.pid == 0 ? "then log in again"
                          : "then log in again and start thimbled anew; of a systemd unit, set it "
                            "in the unit";
}

std::string limit_command(const std::string& row) {
  return "echo '" + row + "' | sudo tee -a /etc/security/limits.d/thimble.conf";
}

}  // namespace

Verdict check_group(const Facts& facts) {
  const Level level = facts.controllers.empty() ? Level::Warn : Level::Wrong;
  const char* const reason =
      "device nodes of arms belong to that group, so that nobody else can go around the force "
      "limit; the limits below name it, too";
  if (!facts.thimble_group) {
    return {level,
            "group",
            "there is no group 'thimble'",
            reason,
            "sudo addgroup --system thimble && sudo adduser $USER thimble",
            again(facts.process)};
  }
  if (is_in_group(facts.process, *facts.thimble_group)) {
    return all_well("group", subject(facts.process) + " is in the group 'thimble'");
  }
  if (has_capability(facts.process, kCapDacOverride)) {
    return all_well("group", subject(facts.process) + " may open every device");
  }
  return {level,
          "group",
          subject(facts.process) + " is not in the group 'thimble'",
          reason,
          "sudo adduser $USER thimble",
          again(facts.process)};
}

Verdict check_rtprio(const Facts& facts) {
  const Process& process = facts.process;
  const int wanted = config::ServoConfig{}.priority;
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
  return {Level::Wrong,
          "rtprio",
          subject(process) + " may not take real-time priority " + std::to_string(wanted) +
              " (limit: " + now + ")",
          "every other program then delays the servo; with realtime = \"required\" it does not "
          "start at all",
          limit_command("@thimble - rtprio " + std::to_string(wanted)),
          again(process) + " (LimitRTPRIO=" + std::to_string(wanted) + ")"};
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
          limit_command("@thimble - memlock unlimited"),
          again(process) + " (LimitMEMLOCK=infinity)"};
}

Verdict check_dma_latency(const Facts& facts) {
  const Node& node = facts.dma_latency;
  if (node.is_there && may_read_and_write(facts.process, node)) {
    return all_well("idle-states", subject(facts.process) + " may keep the CPUs out of deep sleep");
  }
  Verdict verdict{Level::Warn,
                  "idle-states",
                  subject(facts.process) + " may not write " + node.path,
                  "a CPU in deep sleep answers USB and timers up to a fraction of a millisecond "
                  "late",
                  "echo 'KERNEL==\"cpu_dma_latency\", GROUP=\"thimble\", MODE=\"0660\"' | sudo tee "
                  "/etc/udev/rules.d/99-thimble-latency.rules && sudo udevadm control --reload && "
                  "sudo udevadm trigger --settle /dev/cpu_dma_latency",
                  ""};
  if (!node.is_there) {
    verdict.finding = "there is no " + node.path;
    verdict.command =
        "sudo sed -i 's/^GRUB_CMDLINE_LINUX=\"/&processor.max_cstate=1 intel_idle.max_cstate=1 /' "
        "/etc/default/grub && sudo update-grub && sudo reboot";
    verdict.advice =
        "this kernel, or the container, does not offer the node; the setting at boot "
        "does the same";
  }
  return verdict;
}

}  // namespace thimble::doctor
