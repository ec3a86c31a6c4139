#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cli/service_state.hpp"
#include "daemon/config/config.hpp"
#include "hal/linux/gpio_inventory.hpp"

namespace thimble::doctor {

// What can be learnt of a machine without changing it, as the checks need it. Plain values;
// whatever could not be read is empty.

// One row of /proc/PID/limits, of its hard or its soft column.
struct Limit {
  bool is_unlimited{false};
  std::uint64_t value{0};
  bool operator==(const Limit&) const = default;
};

// By what a process is known to be the daemon: never by what it calls itself.
enum class KnownBy : std::uint8_t {
  Nothing,
  Socket,   // it listens at the socket of the API
  Program,  // it runs the program that is installed
};

// Whose rights are looked at: the daemon that runs, else this very program.
struct Process {
  int pid{0};  // 0: no daemon is known to run, it is this program's
  KnownBy known_by{KnownBy::Nothing};
  std::uint32_t user{0};
  std::string user_name;  // empty: the number has none
  // Known by its program only, which anybody may start, and of somebody other than root, the
  // service's user and who asks: no command may give it a right.
  bool is_a_strangers{false};
  std::string unit;                         // of systemd that runs it: "thimbled.service"
  std::vector<std::uint32_t> groups;        // the primary one, too
  std::vector<std::uint32_t> login_groups;  // that its user would have after a login now
  std::uint64_t capabilities{0};            // effective, bit n is capability n of capabilities(7)
  std::optional<Limit> rtprio;              // soft: what sched_setscheduler() asks
  std::optional<Limit> memlock;             // hard: the daemon raises the soft one itself
  bool operator==(const Process&) const = default;
};

// What an access control list says of one user or group: the read (04), write (02) and execute (01)
// that its mask leaves, which may be nothing.
struct AccessEntry {
  std::uint32_t id{0};
  std::uint32_t rights{0};
  bool operator==(const AccessEntry&) const = default;
};

// Whom an access control list speaks of besides owner and everybody.
struct AccessList {
  std::vector<AccessEntry> users;
  std::vector<AccessEntry> groups;
  std::optional<std::uint32_t> group_rights;  // of the owning group; none: there is no list
  bool is_unreadable{false};  // there is a list, and it is not known whom it lets in
  bool operator==(const AccessList&) const = default;
};

struct Node {
  std::string path;  // "/dev/hidraw0"
  bool is_there{false};
  // Those of which each lets a process command the device behind it: hidraw_ioctl() and
  // hiddev_ioctl() of the kernel send for whoever has opened the node, be it only for reading;
  // usbdev_do_ioctl() asks whether it was opened for writing.
  std::uint32_t commanding_rights{06};
  // The nine permission bits. Where there is an access control list, stat(2) gives its mask for the
  // group's: here they are the group's own all the same.
  std::uint32_t mode{0};
  std::uint32_t user{0};
  std::uint32_t group{0};
  AccessList access_list{};
  bool operator==(const Node&) const = default;
};

// Some other process, as a finding names it.
struct NamedProcess {
  int pid{0};
  std::string name;  // what it calls itself
  std::uint32_t user{0};
  std::string user_name;  // empty: the number has none
  bool operator==(const NamedProcess&) const = default;
};

// A device that a driver knows as an arm: of HID by its ids and the lengths of its reports, of USB
// by its ids and endpoints.
struct Controller {
  std::string address;  // "hid:SERIAL", "serial:…" or "usb:…", as in a configuration
  // What configurations of before decision 0507 called it, by the kernel's name of its port:
  // "hid:1-4". No address today.
  std::string former_address;
  Node node;                    // by which the daemon drives it
  std::vector<Node> raw_nodes;  // other ways to it: /dev/bus/usb/001/004, /dev/usb/hiddev0
  std::uint16_t vendor_id{0};
  std::uint16_t product_id{0};
  std::string serial_number;
  std::string usb_port;               // "1-4.2": bus 1, port 4, then port 2 of the hub there
  std::string speed_mbit_per_s;       // as the kernel writes it: "1.5", "12", "480", "5000"
  std::string power_control;          // "on" or "auto"
  std::vector<NamedProcess> holders;  // of one of its nodes, but for the daemon and its guard
  bool is_held_by_the_daemon{false};
  bool operator==(const Controller&) const = default;
};

// A real arm of the configuration.
struct ConfiguredArm {
  std::string name;
  std::string device;  // its address
  bool operator==(const ConfiguredArm&) const = default;
};

// A chip that may have the lines of [safety].
struct GpioChip {
  std::string label;
  std::vector<linux::GpioLineInfo> lines;
  Node node;
  std::string device;                 // whose chip it is, as /sys calls it: "0003:10C4:EA90.0001"
  std::vector<NamedProcess> holders;  // of the node, but for the daemon
  bool is_held_by_the_daemon{false};
  bool operator==(const GpioChip&) const = default;
};

// The file that the daemon is, or would be, started with.
struct ConfigurationFile {
  std::string file;                   // empty: none was looked at
  std::vector<std::string> mistakes;  // as `thimbled --check` says them
  std::vector<std::string> doubts;    // likewise: no mistakes, but will most likely be missed
  bool is_hidden{false};              // who asks may not read it
  bool may_service_read{true};
  bool operator==(const ConfigurationFile&) const = default;
};

struct Cpu {
  unsigned number{0};
  std::string governor;  // empty: its frequency is not the kernel's to choose
  bool operator==(const Cpu&) const = default;
};

struct Facts {
  std::string kernel_release;  // "6.1.0-50-rt-amd64"
  std::string kernel_version;  // "#1 SMP PREEMPT_RT Debian …"
  bool is_realtime_kernel{false};
  std::optional<std::int64_t> rt_runtime_us;  // for real-time threads of each period; -1: all
  std::optional<std::int64_t> rt_period_us;
  std::optional<cli::ServiceState> service{};  // none: not known, or not installed
  ConfigurationFile configuration{};
  Process process;
  std::string daemon_trouble;           // why a daemon that seems to be there is not looked at
  std::vector<NamedProcess> namesakes;  // called "thimbled", and not known to be it
  config::ServoConfig servo;            // what the daemon is to ask for
  std::optional<std::uint32_t> thimble_group;  // the number of the group 'thimble'
  std::string unknown_accounts;                // why users and groups could not be looked up
  Node dma_latency;
  std::string
      idle_driver;  // that puts CPUs to sleep: "intel_idle"; empty or "none": no driver does
  std::string clock_source;
  std::vector<std::string> clock_sources;  // to choose from
  std::vector<Cpu> cpus;
  bool has_hidraw{false};  // the kernel shows HID devices, though there may be none
  std::vector<Controller> controllers;
  std::vector<ConfiguredArm> configured_arms;    // real ones
  std::optional<config::SafetyConfig> safety{};  // the lines that a configuration names
  std::vector<GpioChip> gpio_chips;              // looked at only for these
  std::vector<std::string> unread_gpio_chips;    // nodes that who asks may not open
  std::size_t hidden_processes{0};               // whose open files this user may not see
  bool operator==(const Facts&) const = default;
};

}  // namespace thimble::doctor
