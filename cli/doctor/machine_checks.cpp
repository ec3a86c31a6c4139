#include <algorithm>
#include <string>
#include <string_view>

#include "cli/doctor/checks.hpp"

namespace thimble::doctor {
namespace {

// The kernel's defaults, Documentation/scheduler/sched-rt-group.rst.
constexpr std::int64_t kUsualPeriod_us = 1'000'000;
constexpr std::int64_t kUsualShare_percent = 95;

// "950 of each 1000 ms".
std::string share_text(std::int64_t share_us, std::int64_t period_us) {
  return std::to_string(share_us / 1000) + " of each " + std::to_string(period_us / 1000) + " ms";
}

bool is_any_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

std::string cpu_list(const std::vector<Cpu>& cpus) {
  std::string list;
  for (const Cpu& cpu : cpus) {
    if (cpu.governor.empty() || cpu.governor == "performance") continue;
    list += (list.empty() ? "" : ", ") + std::to_string(cpu.number) + " '" + cpu.governor + "'";
  }
  return list;
}

}  // namespace

Verdict check_kernel(const Facts& facts) {
  const std::string kernel = "Linux " + facts.kernel_release;
  if (facts.kernel_release.empty()) {
    return {Level::Warn,
            "kernel",
            "the kernel does not tell its version",
            "how late the servo may wake depends on the kernel",
            "",
            "/proc must be mounted: look there yourself for PREEMPT_RT",
            "uname -a"};
  }
  if (facts.is_realtime_kernel || facts.kernel_version.find("PREEMPT_RT") != std::string::npos) {
    return all_well("kernel", kernel + ", PREEMPT_RT");
  }
  return {
      Level::Warn,
      "kernel",
      kernel + " is no real-time kernel",
      "without PREEMPT_RT a loaded machine wakes the servo milliseconds late; the arm then "
      "buzzes, or stops with the fault 'servo-late'",
      "sudo apt-get install linux-image-rt-$(dpkg --print-architecture)",
      "then start the machine anew, with that kernel; till then preempt=full on the command line "
      "of this one helps"};
}

Verdict check_realtime_share(const Facts& facts) {
  if (!facts.rt_runtime_us) {
    return {Level::Warn,
            "rt-share",
            "the share of time for real-time threads is not known",
            "beyond its share the kernel stops the servo until the next period",
            "",
            "/proc must be mounted",
            "sysctl kernel.sched_rt_runtime_us kernel.sched_rt_period_us"};
  }
  const std::int64_t share_us = *facts.rt_runtime_us;
  const std::int64_t period_us = facts.rt_period_us.value_or(kUsualPeriod_us);
  const std::int64_t usual_us = period_us / 100 * kUsualShare_percent;
  if (share_us < 0) return all_well("rt-share", "real-time threads may run all the time");
  if (share_us >= usual_us && share_us > 0) {
    return all_well("rt-share", "real-time threads may run " + share_text(share_us, period_us));
  }
  return {share_us == 0 ? Level::Wrong : Level::Warn,
          "rt-share",
          share_us == 0 ? "the kernel lets no real-time thread run"
                        : "real-time threads may run only " + share_text(share_us, period_us),
          "beyond its share the kernel stops the servo until the next period",
          "echo 'kernel.sched_rt_runtime_us = " + std::to_string(usual_us) +
              "' | sudo tee /etc/sysctl.d/99-thimble.conf && sudo sysctl -p "
              "/etc/sysctl.d/99-thimble.conf",
          ""};
}

Verdict check_clock_source(const Facts& facts) {
  const std::string& source = facts.clock_source;
  if (source.empty()) {
    return {Level::Warn,
            "clock",
            "the clock source is not known",
            "a slow clock costs every tick, a coarse one makes every tick late",
            "",
            "/sys must be mounted",
            "cat /sys/devices/system/clocksource/clocksource0/current_clocksource"};
  }
  const bool is_coarse = is_any_of(source, {"jiffies", "refined-jiffies", "pit"});
  if (!is_coarse && !is_any_of(source, {"hpet", "acpi_pm"})) {
    return all_well("clock", "clock source '" + source + "'");
  }
  Verdict verdict{is_coarse ? Level::Wrong : Level::Warn,
                  "clock",
                  "clock source '" + source + "' is " + (is_coarse ? "coarse" : "slow"),
                  is_coarse ? "it ticks every few milliseconds, so the servo cannot run at 1 kHz"
                            : "each look at it takes about a microsecond, and each tick looks "
                              "several times",
                  "",
                  ""};
  const auto& choice = facts.clock_sources;
  if (std::find(choice.begin(), choice.end(), "tsc") != choice.end()) {
    verdict.command =
        "echo tsc | sudo tee /sys/devices/system/clocksource/clocksource0/current_clocksource";
    verdict.advice =
        "lasts until the next start of the machine; the kernel parameter clocksource=tsc keeps it";
  } else {
    verdict.look_with = "sudo dmesg | grep -i -e tsc -e clocksource";
    verdict.advice =
        "the kernel says there why it took no better one; firmware settings or an "
        "update of the firmware often mend it";
  }
  return verdict;
}

Verdict check_governor(const Facts& facts) {
  const char* const reason =
      "the servo sleeps most of the time; other governors take that for a reason to keep its CPU "
      "slow when it wakes";
  if (facts.cpus.empty()) {
    return {Level::Warn,
            "governor",
            "the CPUs are not known",
            reason,
            "",
            "/sys must be mounted",
            "ls /sys/devices/system/cpu"};
  }
  const std::string slow = cpu_list(facts.cpus);
  if (slow.empty()) {
    const bool is_chosen = std::any_of(facts.cpus.begin(), facts.cpus.end(),
                                       [](const Cpu& cpu) { return !cpu.governor.empty(); });
    return all_well("governor", is_chosen
                                    ? "every CPU whose frequency the kernel chooses runs at "
                                      "'performance'"
                                    : "the frequency of the CPUs is not this kernel's to choose");
  }
  return {Level::Warn,
          "governor",
          "the frequency of CPU " + slow + " is not held at its most",
          reason,
          "echo performance | sudo tee /sys/devices/system/cpu/cpu*/cpufreq/scaling_governor",
          "lasts until the next start of the machine, or until a program that saves power sets it "
          "again"};
}

}  // namespace thimble::doctor
