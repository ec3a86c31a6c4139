#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "cli/doctor/checks.hpp"
#include "cli/doctor/rights.hpp"
#include "cli/doctor/udev_rules.hpp"

namespace thimble::doctor {
namespace {

constexpr std::uint32_t kRoot = 0;
constexpr const char* kWhyClosed =
    "whoever may open it, be it only to read, can send the arm forces that pass no limit of ours";
constexpr const char* kWhyNotWritten =
    "whoever may write it can take the arm from its driver and send it forces that pass no limit "
    "of ours";

std::string name(const char* check, const Controller& controller) {
  return std::string(check) + " " + controller.node.path;
}

std::string sysfs_of(const Controller& controller) {
  return "/sys/bus/usb/devices/" + controller.usb_port;
}

// Those whom an access control list gives one of the rights, but for the one who has it anyhow.
std::string list_of(const char* what, const std::vector<AccessEntry>& entries, std::uint32_t rights,
                    std::optional<std::uint32_t> welcome) {
  std::string list;
  for (const AccessEntry& entry : entries) {
    if ((entry.rights & rights) != 0 && entry.id != welcome)
      list += what + std::to_string(entry.id);
  }
  return list;
}

const char* verb_of(const Node& node) {
  return node.commanding_rights == kWrite ? "write" : "open";
}

// Who may command the arm by a node that is there, besides root and the group: nothing when all is
// well. Group 0 is root's own: the kernel makes its nodes root:root.
std::string stranger(const Facts& facts, const Node& node) {
  const std::uint32_t rights = node.commanding_rights;
  if ((node.mode & rights) != 0)
    return std::string("every user may ") + verb_of(node) + " " + node.path;
  if (node.user != kRoot) {
    return node.path + " belongs to user " + std::to_string(node.user) + " and not to root";
  }
  if ((node.mode >> 3U & rights) != 0 && node.group != kRoot && node.group != facts.thimble_group) {
    const bool is_known = facts.thimble_group || facts.unknown_accounts.empty();
    return node.path + " belongs to group " + std::to_string(node.group) +
           (is_known ? " and not to the group 'thimble'"
                     : "; whether that is 'thimble' is not known");
  }
  const AccessList& list = node.access_list;
  if (list.is_unreadable) {
    return "the access control list of " + node.path + " cannot be read";
  }
  const std::string named = list_of(" user ", list.users, rights, kRoot) +
                            list_of(" group ", list.groups, rights, facts.thimble_group);
  if (named.empty()) return "";
  return std::string("an access control list lets others ") + verb_of(node) + " " + node.path +
         ":" + named;
}

Verdict closed_verdict(const Facts& facts, const Controller& controller, const Node& node,
                       const std::string& check, const std::string& finding) {
  Verdict verdict{Level::Wrong,
                  check,
                  finding,
                  verb_of(node) == std::string_view("write") ? kWhyNotWritten : kWhyClosed,
                  closing_command(controller),
                  ""};
  verdict.look_with = rules_that_speak_of(controller);
  verdict.advice = "it closes all nodes of every device with these ids";
  // A rule that names a group which is not there gives the node to the group root.
  if (!facts.thimble_group && facts.unknown_accounts.empty()) {
    verdict.command = "sudo addgroup --system thimble && " + verdict.command;
  }
  if (node.access_list != AccessList{}) {
    // First: taken away later, it would leave what the kernel made of the group's right meanwhile.
    verdict.command = "sudo setfacl --remove-all " + node.path + "; " + verdict.command;
    verdict.advice +=
        "; setfacl is in the package 'acl': without it, then unplug the arm and plug it in again";
  }
  return verdict;
}

// To whom a signal means something else, for the whole machine.
bool is_held_by_init(const Controller& controller) {
  return std::any_of(controller.holders.begin(), controller.holders.end(),
                     [](const NamedProcess& holder) { return holder.pid == 1; });
}

// "bus-port.port…": each dot is a hub.
bool is_behind_hub(const std::string& port) { return port.find('.') != std::string::npos; }

Verdict missing_node(const Controller& controller) {
  const std::string& path = controller.node.path;
  Verdict verdict{
      Level::Wrong,
      name("node", controller),
      "the kernel knows the device, but " + path + " is missing",
      "without its node nothing can talk to the arm",
      "",
      "unplug the arm and plug it in again: the kernel makes the node anew; a container "
      "must be given it: --device " +
          path};
  if (controller.usb_port.empty()) {
    verdict.look_with = "ls -l /dev/hidraw*";
    return verdict;
  }
  // As if it were unplugged and plugged in; udev alone makes no nodes, the kernel's devtmpfs does.
  const std::string file = sysfs_of(controller) + "/authorized";
  verdict.command = "echo 0 | sudo tee " + file + " && echo 1 | sudo tee " + file;
  return verdict;
}

}  // namespace

Verdict check_arms(const Facts& facts) {
  if (facts.has_hidraw) return all_well("arms", "no arm that a driver knows is plugged in");
  return {Level::Warn,
          "arms",
          "the kernel shows no HID devices",
          "an arm on HID is seen and driven by its hidraw device",
          "sudo modprobe hid",
          "/sys must be mounted; a container sees those of its host",
          "ls /sys/class/hidraw"};
}

Verdict check_configured_arm(const Facts& facts, const ConfiguredArm& arm) {
  const std::string check = "arm " + arm.name;
  const bool is_there =
      std::any_of(facts.controllers.begin(), facts.controllers.end(),
                  [&](const Controller& controller) { return controller.address == arm.device; });
  if (is_there) return all_well(check, arm.device + " is plugged in");
  Verdict verdict{Level::Warn,
                  check,
                  "no arm that a driver knows is at " + arm.device,
                  "the daemon runs without it, and takes it when it comes",
                  "",
                  "plug it in, or correct its device in the configuration",
                  "thimble devices"};
  for (const Controller& controller : facts.controllers) {
    if (controller.former_address != arm.device) continue;
    verdict.advice += ": what the kernel calls so today is " + controller.address +
                      ", which may be another one than was meant";
  }
  return verdict;
}

Verdict check_node(const Facts& facts, const Controller& controller) {
  const Node& node = controller.node;
  const std::string check = name("node", controller);
  if (!node.is_there) return missing_node(controller);
  const std::string open_to = stranger(facts, node);
  if (!open_to.empty()) return closed_verdict(facts, controller, node, check, open_to);
  if (may(facts.process, node, kRead | kWrite)) {
    return all_well(check, node.path + " may be opened by the daemon, and by nobody else" +
                               (node.commanding_rights == kWrite ? " for writing" : ""));
  }
  Verdict verdict = closed_verdict(facts, controller, node, check,
                                   node.path + " may not be read and written by the daemon");
  verdict.reason = "the arm cannot be opened";
  verdict.advice += "; the daemon must run in the group 'thimble'";
  return verdict;
}

Verdict check_raw_node(const Facts& facts, const Controller& controller, const Node& node) {
  const std::string check = "raw-node " + node.path;
  if (!node.is_there) return all_well(check, node.path + " is not here");
  const std::string open_to = stranger(facts, node);
  if (!open_to.empty()) return closed_verdict(facts, controller, node, check, open_to);
  return all_well(check, std::string("only root and the group 'thimble' may ") + verb_of(node) +
                             " " + node.path);
}

Verdict check_usb_speed(const Controller& controller) {
  const std::string check = name("usb-speed", controller);
  if (controller.speed_mbit_per_s == "1.5") {
    return {Level::Wrong,
            check,
            "it runs at low speed (1.5 Mbit/s)",
            "low-speed devices are asked at most 100 times a second, the servo needs 1000",
            "",
            "the controller's firmware or its cable is not the right one; an arm shows 12M or more "
            "there",
            "lsusb -t"};
  }
  if (controller.speed_mbit_per_s.empty()) {
    return {Level::Warn,
            check,
            "its USB speed is not known",
            "below full speed (12 Mbit/s) it cannot keep up with the servo",
            "",
            "it is no USB device, or the kernel does not tell",
            "lsusb -t"};
  }
  return all_well(check, "it runs at " + controller.speed_mbit_per_s + " Mbit/s");
}

Verdict check_usb_port(const Controller& controller) {
  const std::string check = name("usb-port", controller);
  if (!is_behind_hub(controller.usb_port)) {
    return all_well(check, controller.usb_port.empty()
                               ? "it has no USB port"
                               : "it is in port " + controller.usb_port + " of the machine itself");
  }
  return {Level::Warn,
          check,
          "it is behind a hub (port " + controller.usb_port + ")",
          "a hub adds up to a millisecond, and the other devices behind it take their share",
          "",
          "plug it into a port of the machine itself: directly below a root_hub there",
          "lsusb -t"};
}

Verdict check_usb_power(const Controller& controller) {
  const std::string check = name("usb-power", controller);
  if (controller.power_control != "auto") {
    return all_well(check, "the kernel does not put it to sleep");
  }
  return {Level::Warn,
          check,
          "the kernel may put it to sleep while there is no traffic",
          "waking it takes longer than the servo waits: the arm faults on activation",
          "echo on | sudo tee " + sysfs_of(controller) + "/power/control",
          "lasts until it is unplugged"};
}

Verdict check_holders(const Facts& facts, const Controller& controller) {
  const std::string check = name("holder", controller);
  std::string others;
  std::string pids;
  for (const NamedProcess& holder : controller.holders) {
    others += (others.empty() ? "'" : ", '") + holder.name + "' (" +
              process_of_user(holder.pid, holder.user, holder.user_name) + ")";
    pids += " " + std::to_string(holder.pid);
  }
  if (!others.empty()) {
    return {Level::Wrong,
            check,
            "it is also held by " + others,
            "two programs take each other's replies, and the other one's forces pass no limit of "
            "ours",
            is_held_by_init(controller) ? "" : "sudo kill" + pids,
            "look first what it belongs to: a service comes back, so stop and disable it with "
            "systemctl; a daemon of yours is known by its socket (--socket)",
            "systemctl status" + pids};
  }
  if (facts.hidden_processes > 0) {
    return {Level::Warn,
            check,
            "no holder was found, but " + std::to_string(facts.hidden_processes) +
                " processes could not be looked at",
            "a program that holds the device takes its replies",
            "",
            "root may look at them all",
            "sudo thimble doctor"};
  }
  return all_well(check, controller.is_held_by_the_daemon ? "thimbled holds it, and nobody else"
                                                          : "nobody holds it");
}

std::vector<Verdict> examine(const Facts& facts) {
  std::vector<Verdict> verdicts{
      check_kernel(facts),   check_realtime_share(facts), check_clock_source(facts),
      check_governor(facts), check_daemon(facts),         check_group(facts),
      check_rtprio(facts),   check_memlock(facts),        check_dma_latency(facts)};
  for (const auto& check : {check_service, check_configuration}) {
    for (Verdict& verdict : check(facts)) verdicts.push_back(std::move(verdict));
  }
  if (facts.controllers.empty()) verdicts.push_back(check_arms(facts));
  for (const ConfiguredArm& arm : facts.configured_arms) {
    verdicts.push_back(check_configured_arm(facts, arm));
  }
  for (const Controller& controller : facts.controllers) {
    verdicts.push_back(check_node(facts, controller));
    for (const Node& node : controller.raw_nodes) {
      verdicts.push_back(check_raw_node(facts, controller, node));
    }
    verdicts.push_back(check_usb_speed(controller));
    verdicts.push_back(check_usb_port(controller));
    verdicts.push_back(check_usb_power(controller));
    verdicts.push_back(check_holders(facts, controller));
  }
  for (Verdict& verdict : check_safety(facts)) verdicts.push_back(std::move(verdict));
  return verdicts;
}

}  // namespace thimble::doctor
