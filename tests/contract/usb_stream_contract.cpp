#include "tests/contract/usb_device_contract.hpp"

namespace thimble::test {
namespace {

using bus::UsbDelivery;
using Packet = UsbRig::Packet;

constexpr std::uint8_t kBulkOut = UsbRig::kBulkOut;

TEST_P(UsbDeviceContract, AnOutputThatIsAStreamLosesNothingAndSaysWhenItIsFull) {
  sut.reset();
  bus::UsbClaim claim;
  claim.pipes.push_back({kBulkOut, UsbDelivery::Every});
  sut = rig->buses().open_usb(rig->address(), claim).value();
  std::vector<Packet> sent;
  const auto send = [&](std::size_t most) {
    for (std::size_t i = 0; i < most; ++i) {
      const Packet packet = pattern(1 + sent.size() % 64, static_cast<std::uint8_t>(sent.size()));
      const IoStatus status = sut->submit(kBulkOut, packet);
      if (status == IoStatus::Backlogged) return;
      ASSERT_EQ(status, IoStatus::Ok);
      sent.push_back(packet);
    }
  };
  rig->set_deaf(kBulkOut, true);
  send(10);
  run_frames(3);
  send(10 * bus::kUsbQueuedPackets);
  // Behind a cable that a fault may hold up, some more.
  EXPECT_GE(sent.size(), bus::kUsbQueuedPackets);
  EXPECT_LE(sent.size(), bus::kUsbQueuedPackets + 3);
  EXPECT_TRUE(rig->received_by_device(kBulkOut).empty());
  rig->set_deaf(kBulkOut, false);
  for (int i = 0; i < 1000 && rig->received_by_device(kBulkOut).size() < 200; ++i) {
    run_frames(1);
    send(200 - sent.size());
  }
  EXPECT_EQ(rig->received_by_device(kBulkOut), sent);
  EXPECT_EQ(sut->counters(kBulkOut).packets_out, 200U);
  EXPECT_EQ(sut->counters(kBulkOut).writes_superseded, 0U);

  rig->device_stalls_once(kBulkOut);
  sent.clear();
  send(5);
  run_frames(10);
  EXPECT_EQ(rig->received_by_device(kBulkOut).size(), 204U) << "the one that was refused is lost";
  EXPECT_EQ(sut->counters(kBulkOut).stalls, 1U);
}

}  // namespace
}  // namespace thimble::test
