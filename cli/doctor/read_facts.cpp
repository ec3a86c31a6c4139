#include "cli/doctor/read_facts.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "cli/doctor/accounts.hpp"
#include "cli/doctor/file_tree.hpp"
#include "cli/doctor/proc_text.hpp"
#include "cli/doctor/read_controllers.hpp"
#include "cli/doctor/read_daemon.hpp"
#include "cli/doctor/read_gpio.hpp"
#include "hal/bus/device_address.hpp"

// Paths: proc(5); Documentation/ABI/testing/sysfs-devices-system-cpu and -clocksource of the
// kernel.
namespace thimble::doctor {
namespace {

namespace fs = std::filesystem;

constexpr const char* kClock = "/sys/devices/system/clocksource/clocksource0";
constexpr const char* kCpus = "/sys/devices/system/cpu";

std::vector<int> processes(const FileTree& tree) {
  std::vector<int> pids;
  for (const std::string& name : tree.names_in("/proc")) {
    const auto pid = parse_integer(name);
    if (pid && *pid > 0 && *pid <= 0x7FFFFFFF) pids.push_back(static_cast<int>(*pid));
  }
  std::sort(pids.begin(), pids.end());
  return pids;
}

fs::path folder_of(int pid) { return fs::path("/proc") / std::to_string(pid); }

// The value, or what stands for none, with why it is not known.
template <class Value>
Value value_or_why(Result<Value> found, std::string& why) {
  if (found) return *std::move(found);
  why = found.error().message;
  return Value{};
}

void read_accounts(const Accounts& accounts, Facts& facts) {
  std::string& why = facts.unknown_accounts;
  Process& process = facts.process;
  facts.thimble_group = value_or_why(accounts.group("thimble"), why);
  process.user_name = value_or_why(accounts.user_name(process.user), why);
  if (process.user_name.empty()) return;
  process.login_groups = value_or_why(accounts.groups_of(process.user_name), why);
}

// Of those that only run the program; who listens at the socket has a place of its own.
bool is_a_strangers(const Process& process, const FileTree& tree) {
  Process asking;
  parse_status(tree.text("/proc/self/status"), asking);
  return process.known_by == KnownBy::Program && process.user != 0 && process.user != asking.user &&
         process.user_name != "thimble";
}

void name_users(const Accounts& accounts, Facts& facts) {
  const auto name = [&](NamedProcess& process) {
    process.user_name = value_or_why(accounts.user_name(process.user), facts.unknown_accounts);
  };
  for (NamedProcess& process : facts.namesakes) name(process);
  for (Controller& controller : facts.controllers) {
    for (NamedProcess& holder : controller.holders) name(holder);
  }
  for (GpioChip& chip : facts.gpio_chips) {
    for (NamedProcess& holder : chip.holders) name(holder);
  }
}

bool is_node_of(const GpioChip& chip, const std::string& path) { return path == chip.node.path; }

bool is_node_of(const Controller& controller, const std::string& path) {
  return path == controller.node.path ||
         std::any_of(controller.raw_nodes.begin(), controller.raw_nodes.end(),
                     [&](const Node& node) { return node.path == path; });
}

// Whether a process whose open files are hidden may have any: a thread of the kernel has no memory
// of its own, and one that has ended in the meantime has no name.
bool may_hold_files(const FileTree& tree, int pid) {
  if (tree.text(folder_of(pid) / "comm").empty()) return false;
  const std::string status = tree.text(folder_of(pid) / "status");
  return status.empty() || status.find("\nVmSize:") != std::string::npos;
}

// Each of the devices that a process has open is told of it.
template <class Device>
void note_holder(const FileTree& tree, int pid, const std::vector<std::string>& open,
                 const Facts& facts, std::vector<Device>& devices) {
  for (Device& device : devices) {
    if (std::none_of(open.begin(), open.end(),
                     [&](const std::string& path) { return is_node_of(device, path); })) {
      continue;
    }
    const NamedProcess holder = named_process(tree, pid);
    if (pid == facts.process.pid) device.is_held_by_the_daemon = true;
    if (!is_ours(tree, holder, facts)) device.holders.push_back(holder);
  }
}

void read_holders(const FileTree& tree, const std::vector<int>& pids, Facts& facts) {
  if (facts.controllers.empty() && facts.gpio_chips.empty()) return;
  for (const int pid : pids) {
    const auto files = tree.names(folder_of(pid) / "fd");
    if (!files) {
      if (may_hold_files(tree, pid)) ++facts.hidden_processes;
      continue;
    }
    std::vector<std::string> open;
    for (const std::string& file : *files) open.push_back(tree.link(folder_of(pid) / "fd" / file));
    note_holder(tree, pid, open, facts, facts.controllers);
    note_holder(tree, pid, open, facts, facts.gpio_chips);
  }
}

std::vector<Cpu> read_cpus(const FileTree& tree) {
  std::vector<Cpu> cpus;
  for (const std::string& name : tree.names_in(kCpus)) {
    if (!name.starts_with("cpu")) continue;
    const auto number = parse_integer(std::string_view(name).substr(3));
    if (!number || *number < 0 || *number > 0xFFFF) continue;
    cpus.push_back({static_cast<unsigned>(*number),
                    trimmed(tree.text(fs::path(kCpus) / name / "cpufreq/scaling_governor"))});
  }
  std::sort(cpus.begin(), cpus.end(),
            [](const Cpu& a, const Cpu& b) { return a.number < b.number; });
  return cpus;
}

}  // namespace

Facts read_facts(const fs::path& root, const plugin::DriverRegistry& drivers,
                 const DaemonAtSocket& daemon, const config::Config& config) {
  const FileTree tree(root);
  const std::vector<int> pids = processes(tree);
  Facts facts;
  facts.servo = config.servo;
  facts.safety = config.safety;
  for (const config::ArmConfig& arm : config.arms) {
    if (!bus::is_simulated(arm.device)) facts.configured_arms.push_back({arm.name, arm.device});
  }
  facts.kernel_release = trimmed(tree.text("/proc/sys/kernel/osrelease"));
  facts.kernel_version = trimmed(tree.text("/proc/sys/kernel/version"));
  facts.is_realtime_kernel = trimmed(tree.text("/sys/kernel/realtime")) == "1";
  facts.rt_runtime_us = parse_integer(tree.text("/proc/sys/kernel/sched_rt_runtime_us"));
  facts.rt_period_us = parse_integer(tree.text("/proc/sys/kernel/sched_rt_period_us"));
  read_daemon(tree, pids, daemon, facts);
  const std::unique_ptr<Accounts> accounts = accounts_below(root);
  read_accounts(*accounts, facts);
  facts.process.is_a_strangers = is_a_strangers(facts.process, tree);
  facts.dma_latency = tree.node("/dev/cpu_dma_latency");
  facts.idle_driver = trimmed(tree.text(fs::path(kCpus) / "cpuidle/current_driver"));
  facts.has_hidraw = tree.names("/sys/class/hidraw").has_value();
  facts.clock_source = trimmed(tree.text(fs::path(kClock) / "current_clocksource"));
  facts.clock_sources = words_of(tree.text(fs::path(kClock) / "available_clocksource"));
  facts.cpus = read_cpus(tree);
  facts.controllers = read_controllers(tree, drivers);
  if (facts.safety) read_gpio_chips(tree, facts);
  read_holders(tree, pids, facts);
  name_users(*accounts, facts);
  return facts;
}

}  // namespace thimble::doctor
