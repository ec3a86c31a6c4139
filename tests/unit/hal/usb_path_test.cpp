#include "hal/linux/usb_path.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <string>

#include "hal/bus/device_name.hpp"

namespace thimble::linux {
namespace {

std::string path_of(const std::string& below_devices, std::string_view version = " 2.00") {
  return usb_path_of("/sys/devices/" + below_devices, version);
}

TEST(UsbPath, LeadsFromTheControllerOverHubsToThePort) {
  EXPECT_EQ(path_of("pci0000:00/0000:00:14.0/usb1/1-4"), "pci-0000:00:14.0-usb-0:4");
  EXPECT_EQ(path_of("pci0000:00/0000:00:14.0/usb1/1-1/1-1.4"), "pci-0000:00:14.0-usb-0:1.4");
  EXPECT_EQ(path_of("platform/vhci_hcd.1/usb12/12-8"), "platform-vhci_hcd.1-usb-0:8");
  EXPECT_EQ(path_of("platform/soc@0/fe980000.usb,b/usb1/1-1"),
            "platform-soc_0-fe980000.usb_b-usb-0:1");
}

// Another card in the machine, or a dock, counts buses anew.
TEST(UsbPath, IsTheSameWhateverTheKernelCounts) {
  EXPECT_EQ(path_of("pci0000:00/0000:00:14.0/usb1/1-4"),
            path_of("pci0000:00/0000:00:14.0/usb13/13-4"));
  const std::string behind_bridges = "pci-0000:00:1c.4-00.0-02.0-usb-0:1";
  EXPECT_EQ(path_of("pci0000:00/0000:00:1c.4/0000:05:00.0/0000:06:02.0/usb3/3-1"), behind_bridges);
  EXPECT_EQ(path_of("pci0000:00/0000:00:1c.4/0000:25:00.0/0000:3a:02.0/usb7/7-1"), behind_bridges);
  EXPECT_EQ(path_of("platform/fe800000.dwc3/xhci-hcd.1.auto/usb1/1-1"),
            path_of("platform/fe800000.dwc3/xhci-hcd.4.auto/usb5/5-1"));
}

TEST(UsbPath, OfAControllerThatIsNoneOfItsBridgesBeginsAnew) {
  EXPECT_EQ(path_of("platform/fd500000.pcie/pci0000:00/0000:00:00.0/0000:01:00.0/usb1/1-1"),
            "platform-fd500000.pcie-pci-0000:00:00.0-00.0-usb-0:1");
  EXPECT_EQ(path_of("pci0000:00/0000:00:0e.0/pci10000:e0/10000:e0:1d.0/usb1/1-1"),
            "pci-0000:00:0e.0-pci-10000:e0:1d.0-usb-0:1");
}

TEST(UsbPath, ToldApartAreTheTwoRootHubsOfAController) {
  const std::string device = "platform/vhci_hcd.0/usb5/5-1";
  EXPECT_EQ(path_of(device, " 2.00"), "platform-vhci_hcd.0-usb-0:1");
  EXPECT_EQ(path_of(device, " 1.10"), "platform-vhci_hcd.0-usb-0:1");
  EXPECT_EQ(path_of(device, ""), "platform-vhci_hcd.0-usb-0:1");
  EXPECT_EQ(path_of(device, " 3.00"), "platform-vhci_hcd.0-usbv3-0:1");
  EXPECT_EQ(path_of(device, " 3.20"), "platform-vhci_hcd.0-usbv3-0:1");
}

TEST(UsbPath, IsNoneOfWhatIsNoDeviceBelowAController) {
  for (const char* none :
       {"", "1-4", "usb1/1-4", "/usb1/1-4", "pci0000:00/usb1/1-4", "c/usb2/1-4", "c/usb1/usb1",
        "c/usb1/1-4:1.0", "c/usb1/1-", "c/usb1/1-0", "c/usb1/1-4.", "c/usb1/1-.4", "c/usb1/1-4..2",
        "c/usb1/-4", "c/1-4", "c/usb1/1-x", "virtual/misc/uhid/0003:1234:0006.0001"}) {
    EXPECT_EQ(path_of(none), "") << none;
  }
  EXPECT_EQ(usb_path_of("/devices/c/usb1/1-4", ""), "") << "of no sysfs";
  EXPECT_EQ(usb_path_of("", ""), "");
}

TEST(UsbPath, IsBounded) {
  const std::string port = "-usb-0:4";
  const std::string longest(kMaxUsbPathLetters - port.size(), 'c');
  EXPECT_EQ(path_of(longest + "/usb1/1-4"), longest + port);
  EXPECT_EQ(path_of(longest + "c/usb1/1-4"), "");
}

TEST(UsbPath, NamesTheRootHub) {
  EXPECT_EQ(root_hub_above("/sys/devices/c/usb1/1-1/1-1.4"), "/sys/devices/c/usb1");
  EXPECT_EQ(root_hub_above("/sys/devices/c/usb1"), "");
  EXPECT_EQ(root_hub_above(""), "");
}

// Whatever the kernel calls controllers, a configuration can name what is there.
TEST(UsbPath, IsAnAddressOnEachBusOrNone) {
  std::mt19937 random(5);
  const std::string letters = "/////::..--0123usb1-4\n\xff @pciauto";
  std::set<std::string> seen;
  for (int round = 0; round < 20'000; ++round) {
    std::string way;
    for (std::size_t i = random() % 30; i > 0; --i) way += letters[random() % letters.size()];
    const std::string path = path_of(way + "/usb1/1-4.2", std::string(random() % 3, '3'));
    if (path.empty()) continue;
    seen.insert(path);
    EXPECT_LE(path.size(), kMaxUsbPathLetters);
    for (const char* scheme : {"usb:", "hid:", "serial:"}) {
      EXPECT_TRUE(bus::is_device_address(scheme + path)) << path;
    }
    EXPECT_TRUE(bus::is_device_address("hid:" + path + ":1.2"));
    EXPECT_FALSE(bus::is_device_address("usb:" + path + ":1.2")) << "it is all its interfaces";
  }
  EXPECT_GT(seen.size(), 1000U);
}

}  // namespace
}  // namespace thimble::linux
