// The real libusb, as far as a machine without USB devices can tell: it starts without discovery,
// refuses what is no device's node, and gives everything back.
#include <fcntl.h>
#include <gtest/gtest.h>

#include "hal/linux/monotonic_clock.hpp"
#include "hal/linux/usb_transfers.hpp"

namespace thimble::linux {
namespace {

TEST(UsbTransfersOfThisMachine, ANodeThatIsNoUsbDeviceIsRefusedAndClosed) {
  const MonotonicClock clock;
  bus::UsbMailboxes mail({});
  for (int i = 0; i < 20; ++i) {
    const int node = ::open("/dev/null", O_RDWR | O_CLOEXEC);
    ASSERT_GE(node, 0);
    const auto sut = UsbTransfers::open(node, 0, mail, clock);
    ASSERT_FALSE(sut.has_value());
    EXPECT_NE(sut.error().message.find("LIBUSB_ERROR"), std::string::npos) << sut.error().message;
    EXPECT_EQ(::fcntl(node, F_GETFD), -1) << "it must be closed";
  }
}

}  // namespace
}  // namespace thimble::linux
