#include "tests/contract/usb_device_contract.hpp"

#include <algorithm>
#include <iterator>
#include <random>

namespace thimble::test {
namespace {

using bus::UsbDelivery;
using Packet = UsbRig::Packet;

constexpr std::uint8_t kBulkIn = UsbRig::kBulkIn;
constexpr std::uint8_t kBulkOut = UsbRig::kBulkOut;
constexpr std::uint8_t kInterruptIn = UsbRig::kInterruptIn;
constexpr std::uint8_t kInterruptOut = UsbRig::kInterruptOut;

// More than an input may rest after a stall.
constexpr int kHaltedFrames = 100;

Packet bytes_of(const bus::UsbPacket& packet) {
  return {packet.payload().begin(), packet.payload().end()};
}

bus::UsbClaim whole_claim() {
  bus::UsbClaim claim;
  claim.pipes.push_back({kBulkIn, UsbDelivery::Every});
  claim.pipes.push_back({kBulkOut, UsbDelivery::Newest});
  claim.pipes.push_back({kInterruptIn, UsbDelivery::Newest});
  claim.pipes.push_back({kInterruptOut, UsbDelivery::Newest});
  return claim;
}

bus::UsbClaim claim_of(std::uint8_t endpoint) {
  bus::UsbClaim claim;
  claim.pipes.push_back({endpoint, UsbDelivery::Newest});
  return claim;
}

}  // namespace

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(UsbDeviceContract);

UsbDeviceContract::UsbDeviceContract() {
  sut = rig->buses().open_usb(rig->address(), whole_claim()).value();
}

std::vector<Packet> UsbDeviceContract::read_all(std::uint8_t endpoint) {
  std::vector<Packet> packets;
  bus::UsbPacket packet;
  while (sut->read(endpoint, packet) == IoStatus::Ok) packets.push_back(bytes_of(packet));
  return packets;
}

TEST_P(UsbDeviceContract, TheDescriptionTellsTheEndpoints) {
  const std::vector<bus::BusDeviceInfo> devices = rig->buses().list();
  const auto device =
      std::find_if(devices.begin(), devices.end(),
                   [&](const bus::BusDeviceInfo& info) { return info.address == rig->address(); });
  ASSERT_NE(device, devices.end());
  EXPECT_EQ(device->kind, bus::BusKind::Usb);
  const auto bulk_in = std::find_if(
      device->endpoints.begin(), device->endpoints.end(),
      [](const bus::UsbEndpointInfo& endpoint) { return endpoint.address == kBulkIn; });
  ASSERT_NE(bulk_in, device->endpoints.end());
  EXPECT_EQ(bulk_in->interface_number, 0);
  EXPECT_EQ(bulk_in->kind, bus::UsbTransferKind::Bulk);
  EXPECT_EQ(bulk_in->max_packet_bytes, 64);
}

TEST_P(UsbDeviceContract, OnlyOneMayHoldADevice) {
  const auto second = rig->buses().open_usb(rig->address(), claim_of(kBulkIn));
  ASSERT_FALSE(second.has_value());
  EXPECT_EQ(second.error().code, Errc::Busy);
  sut.reset();
  EXPECT_TRUE(rig->buses().open_usb(rig->address(), claim_of(kBulkIn)).has_value());
}

TEST_P(UsbDeviceContract, AnUnknownAddressIsNotFoundAndNamed) {
  const auto device = rig->buses().open_usb({"sim:nowhere"}, whole_claim());
  ASSERT_FALSE(device.has_value());
  EXPECT_EQ(device.error().code, Errc::NotFound);
  EXPECT_NE(device.error().message.find("sim:nowhere"), std::string::npos);
}

TEST_P(UsbDeviceContract, AClaimThatTheDescriptorsDoNotFillIsRefusedAndHoldsNothing) {
  sut.reset();
  bus::UsbClaim twice = claim_of(kBulkIn);
  twice.pipes.push_back({kBulkIn, UsbDelivery::Every});
  bus::UsbClaim elsewhere = claim_of(kBulkIn);
  elsewhere.interface_number = 1;
  bus::UsbClaim isochronous = claim_of(UsbRig::kIsochronousIn);
  isochronous.interface_number = 1;
  for (const bus::UsbClaim& claim :
       {claim_of(0x87), claim_of(0x01), claim_of(0), twice, elsewhere, isochronous}) {
    const auto device = rig->buses().open_usb(rig->address(), claim);
    ASSERT_FALSE(device.has_value());
    EXPECT_EQ(device.error().code, Errc::InvalidArgument) << device.error().message;
  }
  EXPECT_TRUE(rig->buses().open_usb(rig->address(), whole_claim()).has_value());
}

TEST_P(UsbDeviceContract, AUsbDeviceIsNotOpenedAsAnother) {
  sut.reset();
  EXPECT_FALSE(rig->buses().open_hid(rig->address()).has_value());
}

TEST_P(UsbDeviceContract, OpeningSendsNothing) {
  run_frames(5);
  EXPECT_TRUE(rig->received_by_device(kBulkOut).empty());
  EXPECT_TRUE(rig->received_by_device(kInterruptOut).empty());
  EXPECT_TRUE(rig->requests_of_device().empty());
}

TEST_P(UsbDeviceContract, NothingArrivedLeavesTheOutputUntouched) {
  run_frames(3);
  bus::UsbPacket packet;
  packet.sequence = 77;
  packet.size = 3;
  for (const std::uint8_t endpoint : {kBulkIn, kInterruptIn}) {
    EXPECT_EQ(sut->read(endpoint, packet), IoStatus::NoData);
    EXPECT_EQ(sut->counters(endpoint), bus::UsbCounters{});
  }
  EXPECT_EQ(packet.sequence, 77U);
  EXPECT_EQ(packet.size, 3U);
}

TEST_P(UsbDeviceContract, EveryPacketOfAStreamArrivesInOrder) {
  std::vector<Packet> sent;
  for (std::uint8_t i = 1; i <= 20; ++i) sent.push_back(pattern(16, i));
  for (const Packet& packet : sent) rig->device_sends(kBulkIn, packet);
  std::vector<Packet> read;
  for (int i = 0; i < 1000 && read.size() < sent.size(); ++i) {
    run_frames(1);
    std::ranges::move(read_all(kBulkIn), std::back_inserter(read));
  }
  EXPECT_EQ(read, sent);
  EXPECT_EQ(sut->counters(kBulkIn).packets_in, 20U);
  EXPECT_EQ(sut->counters(kBulkIn).packets_skipped, 0U);
}

TEST_P(UsbDeviceContract, OfANewestPipeTheNewestWinsAndTheOthersAreCounted) {
  for (std::uint8_t i = 1; i <= 5; ++i) rig->device_sends(kInterruptIn, pattern(16, i));
  run_frames(10);
  bus::UsbPacket packet;
  ASSERT_EQ(sut->read(kInterruptIn, packet), IoStatus::Ok);
  EXPECT_EQ(bytes_of(packet), pattern(16, 5));
  EXPECT_EQ(packet.sequence, 5U);
  EXPECT_EQ(sut->read(kInterruptIn, packet), IoStatus::NoData);
  EXPECT_EQ(sut->counters(kInterruptIn).packets_in, 5U);
  EXPECT_EQ(sut->counters(kInterruptIn).packets_skipped, 4U);
}

TEST_P(UsbDeviceContract, AFullQueueLosesTheNewerOnesAndTheGapShows) {
  constexpr std::size_t kTooMany = bus::kUsbQueuedPackets + 6;
  for (std::size_t i = 0; i < kTooMany; ++i) {
    rig->device_sends(kBulkIn, pattern(4, static_cast<std::uint8_t>(i)));
  }
  run_frames(kTooMany);
  const std::vector<Packet> read = read_all(kBulkIn);
  ASSERT_EQ(read.size(), bus::kUsbQueuedPackets);
  EXPECT_EQ(read.back(), pattern(4, bus::kUsbQueuedPackets - 1));
  rig->device_sends(kBulkIn, pattern(4, 200));
  run_frames(3);
  bus::UsbPacket packet;
  ASSERT_EQ(sut->read(kBulkIn, packet), IoStatus::Ok);
  EXPECT_EQ(packet.sequence, kTooMany + 1);
  EXPECT_EQ(sut->counters(kBulkIn).packets_skipped, 6U);
}

TEST_P(UsbDeviceContract, APacketOfAnyLengthKeepsIt) {
  for (std::size_t size = 0; size <= 64; ++size) {
    rig->device_sends(kBulkIn, pattern(size, 9));
    run_frames(2);
    ASSERT_EQ(read_all(kBulkIn), std::vector<Packet>{pattern(size, 9)}) << size;
  }
}

TEST_P(UsbDeviceContract, OutputReachesTheDeviceOnceOnly) {
  for (const std::uint8_t endpoint : {kBulkOut, kInterruptOut}) {
    EXPECT_EQ(sut->submit(endpoint, pattern(16, endpoint)), IoStatus::Ok);
    run_frames(10);
    EXPECT_EQ(rig->received_by_device(endpoint), std::vector<Packet>{pattern(16, endpoint)});
    EXPECT_EQ(sut->counters(endpoint).packets_out, 1U);
    EXPECT_EQ(sut->counters(endpoint).writes_cut, 0U);
  }
}

TEST_P(UsbDeviceContract, TheLatestOfSeveralSubmitsWinsAndEachIsCounted) {
  for (std::uint8_t i = 1; i <= 4; ++i) {
    const IoStatus status = sut->submit(kBulkOut, pattern(16, i));
    EXPECT_TRUE(status == IoStatus::Ok || status == IoStatus::Backlogged) << to_string(status);
  }
  run_frames(5);

  ASSERT_FALSE(rig->received_by_device(kBulkOut).empty());
  EXPECT_EQ(rig->received_by_device(kBulkOut).back(), pattern(16, 4));
  const bus::UsbCounters counters = sut->counters(kBulkOut);
  EXPECT_EQ(counters.packets_out, rig->received_by_device(kBulkOut).size());
  EXPECT_EQ(counters.packets_out + counters.writes_superseded, 4U);
}

TEST_P(UsbDeviceContract, ATakenPacketIsOfferedUntilTheDeviceTakesIt) {
  rig->set_deaf(kBulkOut, true);
  EXPECT_EQ(sut->submit(kBulkOut, pattern(16, 1)), IoStatus::Ok);
  run_frames(5);
  EXPECT_EQ(sut->submit(kBulkOut, pattern(16, 2)), IoStatus::Backlogged);
  EXPECT_EQ(sut->submit(kBulkOut, pattern(16, 3)), IoStatus::Backlogged);
  run_frames(5);
  EXPECT_TRUE(rig->received_by_device(kBulkOut).empty());
  EXPECT_EQ(sut->counters(kBulkOut).packets_out, 0U);

  rig->set_deaf(kBulkOut, false);
  run_frames(5);

  EXPECT_EQ(rig->received_by_device(kBulkOut),
            (std::vector<Packet>{pattern(16, 1), pattern(16, 3)}));
  EXPECT_EQ(sut->counters(kBulkOut).writes_superseded, 1U);
  EXPECT_EQ(sut->submit(kBulkOut, pattern(16, 4)), IoStatus::Ok) << "the mailbox is free again";
}

TEST_P(UsbDeviceContract, ADeafPipeHoldsUpNoOther) {
  rig->set_deaf(kBulkOut, true);
  rig->set_deaf(0, true);
  sut->submit(kBulkOut, pattern(16, 1));
  sut->start_control(vendor_request(1));
  rig->device_sends(kBulkIn, pattern(16, 2));
  sut->submit(kInterruptOut, pattern(16, 3));
  run_frames(5);
  EXPECT_EQ(read_all(kBulkIn).size(), 1U);
  EXPECT_EQ(rig->received_by_device(kInterruptOut).size(), 1U);
}

TEST_P(UsbDeviceContract, WhatNoPipeCanCarryIsRefusedAndNotSent) {
  for (const std::size_t size : {std::size_t{0}, std::size_t{65}, std::size_t{1000}}) {
    EXPECT_EQ(sut->submit(kBulkOut, pattern(size, 1)), IoStatus::ProtocolError) << size;
  }
  EXPECT_EQ(sut->submit(kInterruptOut, pattern(17, 1)), IoStatus::ProtocolError);
  bus::UsbPacket packet;
  for (const std::uint8_t endpoint : {std::uint8_t{0}, kBulkIn, std::uint8_t{0x07}}) {
    EXPECT_EQ(sut->submit(endpoint, pattern(4, 1)), IoStatus::ProtocolError);
  }
  for (const std::uint8_t endpoint : {std::uint8_t{0}, kBulkOut, std::uint8_t{0x87}}) {
    EXPECT_EQ(sut->read(endpoint, packet), IoStatus::ProtocolError);
  }
  run_frames(3);
  EXPECT_TRUE(rig->received_by_device(kBulkOut).empty());
  EXPECT_TRUE(rig->received_by_device(kInterruptOut).empty());
  EXPECT_EQ(sut->counters(kBulkOut), bus::UsbCounters{});
  EXPECT_EQ(sut->counters(0x07), bus::UsbCounters{});
}

TEST_P(UsbDeviceContract, AStalledInputIsCountedAndGoesOn) {
  rig->device_stalls_once(kBulkIn);
  rig->device_sends(kBulkIn, pattern(16, 1));
  run_frames(kHaltedFrames);
  EXPECT_EQ(read_all(kBulkIn), std::vector<Packet>{pattern(16, 1)});
  EXPECT_EQ(sut->counters(kBulkIn).stalls, 1U);
  EXPECT_EQ(sut->counters(kBulkIn).packets_in, 1U);
}

TEST_P(UsbDeviceContract, AStalledOutputIsCountedAndNotRepeated) {
  rig->device_stalls_once(kBulkOut);
  sut->submit(kBulkOut, pattern(16, 1));
  run_frames(10);
  EXPECT_TRUE(rig->received_by_device(kBulkOut).empty());
  EXPECT_EQ(sut->counters(kBulkOut).stalls, 1U);
  EXPECT_EQ(sut->counters(kBulkOut).packets_out, 0U);

  EXPECT_EQ(sut->submit(kBulkOut, pattern(16, 2)), IoStatus::Backlogged) << "the last one failed";
  run_frames(10);
  EXPECT_EQ(rig->received_by_device(kBulkOut), std::vector<Packet>{pattern(16, 2)});
  EXPECT_EQ(sut->submit(kBulkOut, pattern(16, 3)), IoStatus::Ok) << "this one did not";
}

TEST_P(UsbDeviceContract, AWayOutThatFailsEveryTimeNeverLooksFree) {
  EXPECT_EQ(sut->submit(kBulkOut, pattern(16, 1)), IoStatus::Ok);
  run_frames(3);
  for (std::uint8_t i = 0; i < 20; ++i) {
    rig->device_stalls_once(kBulkOut);
    EXPECT_EQ(sut->submit(kBulkOut, pattern(16, i)), i == 0 ? IoStatus::Ok : IoStatus::Backlogged);
    rig->device_sends(kBulkIn, pattern(16, i));
    run_frames(3);
    EXPECT_EQ(read_all(kBulkIn).size(), 1U) << "input flows meanwhile";
  }
  EXPECT_EQ(rig->received_by_device(kBulkOut).size(), 1U);
  EXPECT_EQ(sut->counters(kBulkOut).stalls, 20U);
}

TEST_P(UsbDeviceContract, ABabblingPacketIsCountedAndLost) {
  rig->device_sends(kBulkIn, pattern(65, 1));
  rig->device_sends(kBulkIn, pattern(16, 2));
  run_frames(10);
  EXPECT_EQ(read_all(kBulkIn), std::vector<Packet>{pattern(16, 2)});
  EXPECT_EQ(sut->counters(kBulkIn).babbles, 1U);
  EXPECT_EQ(sut->counters(kBulkIn).packets_in, 1U);
}

TEST_P(UsbDeviceContract, AfterUnplugEveryCallSaysDisconnected) {
  rig->device_sends(kBulkIn, pattern(16, 1));
  run_frames(2);
  rig->unplug();
  run_frames(2);
  bus::UsbPacket packet;
  packet.sequence = 77;
  bus::UsbControlReply reply;
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(sut->read(kBulkIn, packet), IoStatus::Disconnected);
    EXPECT_EQ(sut->submit(kBulkOut, pattern(16, 1)), IoStatus::Disconnected);
    EXPECT_EQ(sut->start_control(vendor_request(1)), IoStatus::Disconnected);
    EXPECT_EQ(sut->read_control(reply), IoStatus::Disconnected);
    run_frames(1);
  }
  EXPECT_EQ(packet.sequence, 77U);
  EXPECT_TRUE(rig->received_by_device(kBulkOut).empty());
  EXPECT_TRUE(rig->requests_of_device().empty());
}

TEST_P(UsbDeviceContract, ClosingCancelsWhatIsPendingAndTheNextOpenerStartsAnew) {
  rig->set_deaf(kBulkOut, true);
  rig->set_deaf(0, true);
  sut->submit(kBulkOut, pattern(16, 1));
  sut->start_control(vendor_request(1));
  run_frames(3);
  sut.reset();
  rig->set_deaf(kBulkOut, false);
  rig->set_deaf(0, false);
  run_frames(5);
  EXPECT_TRUE(rig->received_by_device(kBulkOut).empty());
  EXPECT_TRUE(rig->requests_of_device().empty());

  sut = rig->buses().open_usb(rig->address(), whole_claim()).value();
  EXPECT_EQ(sut->submit(kBulkOut, pattern(16, 2)), IoStatus::Ok);
  run_frames(5);
  EXPECT_EQ(rig->received_by_device(kBulkOut), std::vector<Packet>{pattern(16, 2)});
}

// Random traffic on all pipes: a stream loses nothing and keeps its order, stamps never run
// backwards, and every packet ends in exactly one counter.
TEST_P(UsbDeviceContract, TheCountersBalanceUnderRandomTraffic) {
  std::mt19937 random(5);
  std::vector<Packet> sent;
  std::vector<Packet> read;
  std::uint64_t submitted = 0;
  std::uint64_t stalls = 0;
  MonotonicTime last_arrival{};
  const auto drain = [&] {
    bus::UsbPacket packet;
    while (sut->read(kBulkIn, packet) == IoStatus::Ok) {
      EXPECT_GE(packet.arrived_at, last_arrival);
      last_arrival = packet.arrived_at;
      read.push_back(bytes_of(packet));
      EXPECT_EQ(packet.sequence, read.size());
    }
  };
  for (int step = 0; step < 600; ++step) {
    switch (random() % 6) {
      case 0:
        // Beyond what is kept for who does not read, the last are lost unseen.
        if (sent.size() - read.size() >= bus::kUsbQueuedPackets / 2) break;
        sent.push_back(pattern(random() % 65, static_cast<std::uint8_t>(random())));
        rig->device_sends(kBulkIn, sent.back());
        break;
      case 1:
        sut->submit(kBulkOut, pattern(1 + random() % 64, static_cast<std::uint8_t>(++submitted)));
        break;
      case 2:
        rig->device_stalls_once(kBulkIn);
        ++stalls;
        break;
      case 3:
        rig->set_deaf(kBulkOut, random() % 2 == 0);
        break;
      case 4:
        run_frames(static_cast<int>(random() % 3));
        break;
      default:
        drain();
    }
  }
  rig->set_deaf(kBulkOut, false);
  const auto is_all_told = [&] {
    return read.size() == sent.size() && sut->counters(kBulkIn).stalls == stalls;
  };
  for (int frame = 0; frame < 20000 && !is_all_told(); ++frame) {
    run_frames(1);
    drain();
  }
  run_frames(5);
  EXPECT_EQ(read, sent);
  const bus::UsbCounters in = sut->counters(kBulkIn);
  EXPECT_EQ(in.packets_in, sent.size());
  EXPECT_EQ(in.packets_skipped, 0U);
  EXPECT_EQ(in.stalls, stalls);
  const bus::UsbCounters out = sut->counters(kBulkOut);
  EXPECT_EQ(out.packets_out + out.writes_superseded, submitted);
  EXPECT_EQ(out.packets_out, rig->received_by_device(kBulkOut).size());
}

}  // namespace thimble::test
