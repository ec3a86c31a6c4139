#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

// umockdev's own name.
#ifdef __clang__
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wreserved-identifier"
#endif
struct _UMockdevTestbed;
#ifdef __clang__
#pragma clang diagnostic pop
#endif

namespace thimble::test {

// A machine whose devices umockdev invents: the real libudev sees them below /sys and hears of them
// from "udevd". Needs umockdev's library preloaded (umockdev-wrapper), which also leads the names
// below /dev to plain files.
//
// Thread: one. One at a time in a process. Who listens and does not read is soon full: umockdev
// then ends the process (ten events where net.unix.max_dgram_qlen is 10).
class MockMachine {
 public:
  MockMachine();
  ~MockMachine();
  MockMachine(const MockMachine&) = delete;
  MockMachine& operator=(const MockMachine&) = delete;

  using Bytes = std::vector<std::uint8_t>;
  // "1-4" is on the first bus, which a controller has from the beginning on: kController.
  struct UsbDevice {
    std::string port{"1-4"};
    std::string vendor_id{"1234"};
    std::string product_id{"0006"};
    std::string serial_number{};
    std::string product{"Arm"};
    std::string device_class{"00"};
    int number{4};  // on the bus
    Bytes descriptors{};
  };
  struct HidDevice {
    std::string port{"1-4"};
    int interface_number{0};
    int node_number{0};            // 0: /dev/hidraw0
    std::string instance{"0001"};  // the kernel's count of HID devices since it was booted
    std::string ids{"0003:00001234:00000006"};
    std::string serial_number{};  // HID_UNIQ
    Bytes report_descriptor{};
  };

  struct SerialDevice {
    std::string port{"1-4"};
    int interface_number{0};
    std::string name{"ttyACM0"};
    std::string
        terminal{};  // a terminal of the kernel's own to which its node leads; empty: a file
  };

  static constexpr const char* kController = "0000:00:14.0";
  // One more bus of a PCI function, as the kernel counts it today, with its root hub.
  void find_bus(int number, const std::string& controller, const std::string& version = " 2.00");

  // Each returns the path below /sys, and is told of to who listens.
  std::string plug(const UsbDevice& device);
  std::string plug(const HidDevice& device);
  std::string plug(const SerialDevice& device);
  // The hiddev of an interface, "/dev/usb/NAME".
  std::string plug_hiddev(const std::string& port, int interface_number, const std::string& name);
  // One of the machine's own, on no USB.
  std::string plug_console(const std::string& name);
  // One that is on no USB, as of uhid.
  std::string plug_virtual(const HidDevice& device);
  // With all that is below it.
  void unplug(const std::string& path);
  // What "udevd" may also say: a change that is none.
  void say(const std::string& path, const char* action);
  // Whoever reads that file of a descriptor waits until answer(); then it is not there. libudev
  // itself reads no pipes: other attributes will not do.
  void hang(const std::string& path, const std::string& attribute);
  void answer(const std::string& path, const std::string& attribute);
  // Without rights to the nodes.
  void let_others_look();
  // The plain file to which the name of a node leads, "/dev/hidraw0", for its owner and rights.
  [[nodiscard]] std::string file_of(const std::string& node) const { return root() + node; }

 private:
  [[nodiscard]] std::string root() const;
  [[nodiscard]] const std::string& hub_of(const std::string& port) const;
  std::string make_node(const std::string& name);
  std::string plug_interface(const std::string& port, int number);
  std::string plug_node(const char* subsystem, const std::string& name, const std::string& parent,
                        const std::string& folder = "/dev/");
  std::string plug_below(const std::string& parent, const HidDevice& device);

  _UMockdevTestbed* bed_;
  std::string uhid_;
  std::map<std::string, std::string> hubs_;  // paths of root hubs by numbers of buses
  std::vector<std::string> paths_;
  std::map<std::string, int> pipes_;          // ends of what hangs
  std::map<std::string, std::string> nodes_;  // files by path below /sys
};

// USB 2.0, 9.6: of a device of one interface with two bulk endpoints, 0x81 and 0x02.
[[nodiscard]] MockMachine::Bytes bulk_descriptors();
// A HID report descriptor of unnumbered reports of so many bytes each way.
[[nodiscard]] MockMachine::Bytes plain_report_descriptor(std::uint8_t input_bytes,
                                                         std::uint8_t output_bytes);
// The same of reports with the number 1.
[[nodiscard]] MockMachine::Bytes numbered_reports(std::uint8_t input_bytes,
                                                  std::uint8_t output_bytes);

}  // namespace thimble::test
