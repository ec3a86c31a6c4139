// lint: long-file one bench, and all that libusb asks of who uses it
// The real bus's transfers under the USB contract suite, and what libusb asks of who uses it. In
// place of libusb and the kernel stands tests/support/fake_libusb.cpp, in place of the thread the
// test, so that every run is the same. Over a real kernel it is for the VM tier to run.
#include <memory>
#include <random>
#include <utility>

#include "hal/linux/event_fd.hpp"
#include "hal/linux/usb_transfers.hpp"
#include "sim/time/virtual_clock.hpp"
#include "tests/contract/usb_device_contract.hpp"
#include "tests/support/fake_libusb.hpp"
#include "tests/support/scripted_usb_model.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;

class LinuxUsbBench;

// linux::UsbDevice without its thread, but with its way of closing.
class ThreadlessDevice final : public bus::UsbMailboxes {
 public:
  ThreadlessDevice(LinuxUsbBench& bench, std::span<const bus::UsbOpenPipe> pipes)
      : UsbMailboxes(pipes), bench_(&bench) {}
  ~ThreadlessDevice() override;
  [[nodiscard]] Result<void> open(int node, std::uint8_t interface_number, const Clock& clock) {
    auto transfers = linux::UsbTransfers::open(node, interface_number, *this, clock);
    if (!transfers.has_value()) return tl::unexpected(transfers.error());
    transfers_ = std::move(transfers.value());
    return {};
  }
  void turn() noexcept {
    transfers_->serve();
    transfers_->handle_events();
  }
  [[nodiscard]] linux::UsbTransfers::Woken wait(int wake) noexcept {
    return transfers_->wait(wake);
  }

 private:
  LinuxUsbBench* bench_;
  std::unique_ptr<linux::UsbTransfers> transfers_;
};

// One device at a node that the fake leads to the scripted model.
class LinuxUsbBench final : public bus::BusEnumerator {
 public:
  const bus::DeviceAddress address{"usb:1-4"};
  sim::VirtualClock clock;
  std::shared_ptr<UsbModelScript> script = std::make_shared<UsbModelScript>();
  FakeUsbWire wire{std::make_unique<ScriptedUsbModel>(script)};

  std::vector<bus::BusDeviceInfo> list() override {
    bus::BusDeviceInfo info = ScriptedUsbModel(script).describe();
    info.address = address;
    info.kind = bus::BusKind::Usb;
    return {info};
  }
  std::optional<bus::BusEvent> poll_event() override { return std::nullopt; }
  Result<std::unique_ptr<bus::HidDevice>> open_hid(const bus::DeviceAddress&) override {
    return fail(Errc::InvalidArgument, "no HID here");
  }
  Result<std::unique_ptr<bus::UsbDevice>> open_usb(const bus::DeviceAddress& wanted,
                                                   const bus::UsbClaim& claim) override {
    if (wanted != address) return fail(Errc::NotFound, "no device at " + wanted.text);
    const auto pipes = bus::resolve_claim(claim, list().front().endpoints);
    if (!pipes.has_value()) return tl::unexpected(pipes.error());
    auto device = std::make_unique<ThreadlessDevice>(*this, pipes.value());
    const Result<void> opened = device->open(wire.open_node(), claim.interface_number, clock);
    if (!opened.has_value()) return tl::unexpected(opened.error());
    open_ = device.get();
    return device;
  }
  void forget(const ThreadlessDevice& device) noexcept {
    if (open_ == &device) open_ = nullptr;
  }
  void run_for(Duration duration) {
    for (Duration run{}; run < duration; run += milliseconds(1)) {
      run_frame_in_no_time();
      clock.run_for(milliseconds(1));
    }
  }
  void turn() {
    if (open_ != nullptr) open_->turn();
  }
  [[nodiscard]] linux::UsbTransfers::Woken wait(int wake) noexcept { return open_->wait(wake); }
  // The thread is kept from what has happened until the next frame.
  void run_frame_without_turns_after() {
    turn();
    wire.run_frame();
  }
  // As often as a thread might that nothing holds up.
  void run_frame_in_no_time() {
    turn();
    wire.run_frame();
    for (int i = 0; i < 4; ++i) turn();
  }

 private:
  ThreadlessDevice* open_{nullptr};
};

ThreadlessDevice::~ThreadlessDevice() {
  bench_->forget(*this);
  if (transfers_ != nullptr) transfers_->send_last();
}

class LinuxUsbRig final : public UsbRig {
 public:
  ~LinuxUsbRig() override { EXPECT_EQ(bench_.wire.breaches(), std::vector<std::string>{}); }
  bus::BusEnumerator& buses() override { return bench_; }
  bus::DeviceAddress address() const override { return bench_.address; }
  void run_for(Duration duration) override { bench_.run_for(duration); }
  void device_sends(std::uint8_t endpoint, const Packet& packet) override {
    bench_.script->to_send[endpoint].push_back(packet);
  }
  void device_answers_control(const Packet& data) override { bench_.script->control_answer = data; }
  void device_stalls_once(std::uint8_t endpoint) override {
    bench_.script->stalls_to_come.insert(endpoint);
  }
  void set_deaf(std::uint8_t endpoint, bool is_deaf) override {
    if (is_deaf) {
      bench_.script->deaf.insert(endpoint);
    } else {
      bench_.script->deaf.erase(endpoint);
    }
  }
  std::vector<Packet> received_by_device(std::uint8_t endpoint) override {
    return bench_.script->received[endpoint];
  }
  std::vector<bus::UsbControlRequest> requests_of_device() override {
    return bench_.script->requests;
  }
  void unplug() override { bench_.wire.unplug(); }

 private:
  LinuxUsbBench bench_;
};

std::unique_ptr<UsbRig> make() { return std::make_unique<LinuxUsbRig>(); }

INSTANTIATE_TEST_SUITE_P(Linux, UsbDeviceContract,
                         testing::Values(UsbRigFactory{"UsbTransfers", &make}), usb_rig_name);

constexpr std::uint8_t kIn = UsbRig::kBulkIn;
constexpr std::uint8_t kOut = UsbRig::kBulkOut;

struct UsbTransfersTest : testing::Test {
  LinuxUsbBench bench;
  std::unique_ptr<bus::UsbDevice> sut;

  UsbTransfersTest() {
    bus::UsbClaim claim;
    claim.pipes.push_back({kIn, bus::UsbDelivery::Every});
    claim.pipes.push_back({kOut, bus::UsbDelivery::Newest});
    sut = bench.open_usb(bench.address, claim).value();
  }
  ~UsbTransfersTest() override {
    sut.reset();
    EXPECT_EQ(bench.wire.breaches(), std::vector<std::string>{});
    EXPECT_EQ(FakeUsbWire::alive(), 0) << "libusb's objects must all be given back";
  }
  void run_frames(int frames) { bench.run_for(milliseconds(frames)); }
  int read_all() {
    int packets = 0;
    bus::UsbPacket packet;
    while (sut->read(kIn, packet) == IoStatus::Ok) ++packets;
    return packets;
  }
};

TEST_F(UsbTransfersTest, TwoReadsArePendingAfterEveryTurn) {
  for (int frame = 0; frame < 20; ++frame) {
    bench.script->to_send[kIn].push_back(pattern(16, 1));
    run_frames(1);
    ASSERT_EQ(bench.wire.pending(), 2U) << frame;
  }
  EXPECT_EQ(read_all(), 20);
}

TEST_F(UsbTransfersTest, ANodeThatHangsUpIsADeviceThatIsGoneThoughNoTransferSaysSo) {
  const auto wake = linux::EventFd::create().value();
  run_frames(1);
  bench.wire.hang_up();
  EXPECT_TRUE(bench.wait(wake->fd()).has_events);
  bus::UsbPacket packet;
  EXPECT_EQ(sut->read(kIn, packet), IoStatus::Disconnected);
  EXPECT_EQ(sut->submit(kOut, pattern(16, 1)), IoStatus::Disconnected);
  // Which would be so for ever.
  wake->signal();
  const linux::UsbTransfers::Woken woken = bench.wait(wake->fd());
  EXPECT_TRUE(woken.is_signalled);
  EXPECT_FALSE(woken.has_events);
  EXPECT_EQ(bench.wire.pending(), 2U) << "they come home when it is closed";
}

TEST_F(UsbTransfersTest, AHaltIsClearedOnceWithNothingPending) {
  bench.script->stalls_to_come.insert(kIn);
  run_frames(100);
  EXPECT_EQ(bench.wire.halts_cleared(), 1);
  EXPECT_EQ(bench.wire.pending(), 2U);
}

TEST_F(UsbTransfersTest, AHaltOfAnInputRestsWhileOutputGoesOnAndIsClearedAfterTheOutputOfItsTurn) {
  bench.script->stalls_to_come.insert(kIn);
  run_frames(1);
  for (std::uint8_t frame = 1; frame < 50; ++frame) {
    EXPECT_EQ(sut->submit(kOut, pattern(16, frame)), IoStatus::Ok);
    run_frames(1);
    ASSERT_EQ(bench.wire.halts_cleared(), 0) << "the ramp to zero lasts 50 ms";
  }
  EXPECT_EQ(bench.script->received[kOut].size(), 49U);
  sut->submit(kOut, pattern(16, 50));
  run_frames(1);
  EXPECT_EQ(bench.wire.halts_cleared(), 1);
  EXPECT_EQ(bench.wire.outputs_at_last_clearing(), 1U) << "the kernel has it already";
}

// Clearing may keep the kernel for seconds, whichever way the halted pipe goes.
TEST_F(UsbTransfersTest, AHaltedOutputIsClearedAtOnceButAfterAnotherOutput) {
  sut.reset();
  bus::UsbClaim claim;
  claim.pipes.push_back({kOut, bus::UsbDelivery::Newest});
  claim.pipes.push_back({UsbRig::kInterruptOut, bus::UsbDelivery::Newest});
  sut = bench.open_usb(bench.address, claim).value();
  bench.script->deaf.insert(UsbRig::kInterruptOut);
  bench.script->stalls_to_come.insert(kOut);
  sut->submit(kOut, pattern(16, 1));
  bench.run_frame_without_turns_after();
  bench.turn();
  sut->submit(UsbRig::kInterruptOut, pattern(16, 2));
  run_frames(1);
  EXPECT_EQ(bench.wire.halts_cleared(), 1);
  EXPECT_EQ(bench.wire.outputs_at_last_clearing(), 1U);
  sut->submit(kOut, pattern(16, 3));
  run_frames(1);
  EXPECT_EQ(bench.script->received[kOut], std::vector<UsbRig::Packet>{pattern(16, 3)});
}

TEST_F(UsbTransfersTest, ASpoiltReadIsCountedAndTriedAgainNoMoreThanOnceAFrame) {
  bench.wire.spoil_next_reads(6);
  for (int i = 0; i < 5; ++i) bench.run_frame_in_no_time();
  EXPECT_EQ(sut->counters(kIn).failures, 2U) << "each of the two reads";
  run_frames(10);
  bench.script->to_send[kIn].push_back(pattern(16, 1));
  run_frames(2);
  EXPECT_EQ(sut->counters(kIn).failures, 6U);
  EXPECT_EQ(read_all(), 1);
}

// What no bus can bring in a frame: as a device behind a fast emulation does, or a hub gone mad.
struct AFloodOverUsb : UsbTransfersTest {
  static constexpr int kFrames = 20;

  void send(std::size_t bytes) {
    for (int i = 0; i < 5000; ++i) {
      bench.script->to_send[kIn].push_back(pattern(bytes, static_cast<std::uint8_t>(i)));
    }
  }
  void run_flooded_frame() {
    for (int i = 0; i < 100; ++i) bench.run_frame_in_no_time();
    bench.clock.run_for(milliseconds(1));
  }
};

TEST_F(AFloodOverUsb, IsTakenNoFasterThanItCanBeRead) {
  send(16);
  std::uint64_t read = 0;
  for (int i = 0; i < kFrames; ++i) {
    run_flooded_frame();
    read += static_cast<std::uint64_t>(read_all());
  }
  EXPECT_GT(read, 19U * kFrames) << "more than a bus can bring";
  EXPECT_LE(read, bus::kUsbQueuedPackets * kFrames);
  EXPECT_EQ(sut->counters(kIn).packets_in, read) << "none is lost";
}

TEST_F(AFloodOverUsb, ThatNobodyReadsIsTakenByDrops) {
  send(16);
  for (int i = 0; i < kFrames; ++i) run_flooded_frame();
  EXPECT_LE(sut->counters(kIn).packets_in, bus::kUsbQueuedPackets + 4 * kFrames);
  EXPECT_EQ(read_all(), static_cast<int>(bus::kUsbQueuedPackets));
  for (int i = 0; i < 2; ++i) run_flooded_frame();
  EXPECT_GT(read_all(), 40) << "there is room again";
}

TEST_F(AFloodOverUsb, OfBabbleIsNoFaster) {
  send(65);
  for (int i = 0; i < kFrames; ++i) run_flooded_frame();
  EXPECT_GT(sut->counters(kIn).babbles, 0U);
  EXPECT_LE(sut->counters(kIn).babbles, bus::kUsbQueuedPackets * kFrames);
}

TEST_F(UsbTransfersTest, ASubmissionThatIsRefusedIsCountedAndInputGoesOn) {
  run_frames(2);
  bench.wire.refuse_next_submissions(1);
  sut->submit(kOut, pattern(16, 1));
  run_frames(2);
  EXPECT_EQ(sut->counters(kOut).failures, 1U);
  EXPECT_EQ(sut->submit(kOut, pattern(16, 2)), IoStatus::Backlogged) << "nothing reached it";
  bench.script->to_send[kIn].push_back(pattern(16, 1));
  run_frames(1);
  bench.wire.refuse_next_submissions(3);
  bench.script->to_send[kIn].push_back(pattern(16, 2));
  run_frames(10);
  EXPECT_EQ(bench.wire.pending(), 2U);
  EXPECT_EQ(read_all(), 2);
  EXPECT_EQ(bench.script->received[kOut].size(), 1U);
}

TEST_F(UsbTransfersTest, ClosingSendsTheNewestAfterWhatIsUnderWay) {
  sut->submit(kOut, pattern(16, 1));
  bench.run_frame_without_turns_after();
  sut->submit(kOut, pattern(16, 2));
  sut->submit(kOut, pattern(16, 3));
  bench.wire.run_frames_by_events();
  sut.reset();
  EXPECT_EQ(bench.script->received[kOut],
            (std::vector<UsbRig::Packet>{pattern(16, 1), pattern(16, 3)}));
}

TEST_F(UsbTransfersTest, ClosingSendsTheNewestAfterOneThatStalled) {
  bench.script->stalls_to_come.insert(kOut);
  sut->submit(kOut, pattern(16, 1));
  bench.run_frame_without_turns_after();
  sut->submit(kOut, pattern(16, 2));
  bench.wire.run_frames_by_events();
  sut.reset();
  EXPECT_EQ(bench.script->received[kOut], std::vector<UsbRig::Packet>{pattern(16, 2)});
}

TEST_F(UsbTransfersTest, ClosingSendsNothingTwiceAndNothingToADeviceThatIsGone) {
  sut->submit(kOut, pattern(16, 1));
  run_frames(2);
  bench.wire.run_frames_by_events();
  bench.wire.unplug();
  sut->submit(kOut, pattern(16, 2));
  sut.reset();
  EXPECT_EQ(bench.script->received[kOut].size(), 1U);
}

// An output that is a stream: as many packets as have room in a frame, not one.
struct UsbOutputStream : UsbTransfersTest {
  std::vector<UsbRig::Packet> sent;

  UsbOutputStream() {
    sut.reset();
    bus::UsbClaim claim;
    claim.pipes.push_back({kOut, bus::UsbDelivery::Every});
    sut = bench.open_usb(bench.address, claim).value();
  }
  // False: it is full.
  bool try_to_send(std::size_t bytes) {
    const auto packet = pattern(bytes, static_cast<std::uint8_t>(sent.size()));
    if (sut->submit(kOut, packet) != IoStatus::Ok) return false;
    sent.push_back(packet);
    return true;
  }
  void send(std::size_t bytes) { ASSERT_TRUE(try_to_send(bytes)); }
  const std::vector<UsbRig::Packet>& received() { return bench.script->received[kOut]; }
};

TEST_F(UsbOutputStream, WholePacketsLeaveAsFastAsTheBusTakesThem) {
  for (std::size_t i = 0; i < bus::kUsbQueuedPackets; ++i) send(64);
  run_frames(1);
  EXPECT_EQ(received().size(), FakeUsbWire::kMostPacketsInFrame);
  run_frames(3);
  EXPECT_EQ(received(), sent);
  EXPECT_EQ(sut->counters(kOut).packets_out, bus::kUsbQueuedPackets);
}

TEST_F(UsbOutputStream, PacketsComeAsTheyWereWhateverTheirSizes) {
  std::mt19937 random(11);
  std::size_t short_ones = 0;
  for (int frame = 0; frame < 2000; ++frame) {
    for (auto more = random() % 12; more > 0; --more) {
      const std::size_t size = random() % 4 == 0 ? 1 + random() % 63 : 64;
      if (!try_to_send(size)) break;
      if (size < 64) ++short_ones;
    }
    run_frames(1);
  }
  run_frames(bus::kUsbQueuedPackets);
  EXPECT_EQ(received(), sent);
  EXPECT_GT(sent.size(), 2 * 2000U) << "more than one a frame";
  EXPECT_GT(short_ones, 500U);
  EXPECT_EQ(sut->counters(kOut).packets_out, sent.size());
  EXPECT_EQ(sut->counters(kOut).writes_cut, 0U);
}

TEST_F(UsbOutputStream, OneThatIsRefusedInARunIsLostAndNoOther) {
  for (int i = 0; i < 40; ++i) send(64);
  run_frames(1);
  bench.script->stalls_to_come.insert(kOut);
  run_frames(10);
  sent.erase(sent.begin() + FakeUsbWire::kMostPacketsInFrame);
  EXPECT_EQ(received(), sent);
  const bus::UsbCounters counters = sut->counters(kOut);
  EXPECT_EQ(counters.packets_out, 39U);
  EXPECT_EQ(counters.stalls, 1U);
  EXPECT_EQ(counters.writes_cut, 0U);
}

TEST_F(UsbOutputStream, ARunThatTheKernelRefusesCostsItsFirstPacket) {
  for (int i = 0; i < 5; ++i) send(64);
  bench.wire.refuse_next_submissions(1);
  run_frames(3);
  sent.erase(sent.begin());
  EXPECT_EQ(received(), sent);
  EXPECT_EQ(sut->counters(kOut).failures, 1U);
}

TEST_F(UsbOutputStream, AnUnplugWithinARunIsTheEnd) {
  for (int i = 0; i < 40; ++i) send(64);
  run_frames(1);
  bench.wire.unplug();
  run_frames(1);
  EXPECT_EQ(sut->submit(kOut, pattern(64, 1)), IoStatus::Disconnected);
  EXPECT_EQ(received().size(), FakeUsbWire::kMostPacketsInFrame);
}

TEST_F(UsbTransfersTest, AnUnplugEndsEveryTransferAndNothingIsSubmittedAfterIt) {
  bench.script->deaf = {kOut, 0};
  sut->submit(kOut, pattern(16, 1));
  sut->start_control({});
  run_frames(2);
  EXPECT_EQ(bench.wire.pending(), 4U);
  bench.wire.unplug();
  run_frames(5);
  EXPECT_EQ(bench.wire.pending(), 0U);
  EXPECT_EQ(sut->submit(kOut, pattern(16, 1)), IoStatus::Disconnected);
}

TEST_F(UsbTransfersTest, AnUnplugBetweenStallAndClearingIsNoticed) {
  bench.script->stalls_to_come.insert(kOut);
  sut->submit(kOut, pattern(16, 1));
  run_frames(1);
  bench.wire.unplug();
  run_frames(2);
  EXPECT_EQ(sut->submit(kOut, pattern(16, 1)), IoStatus::Disconnected);
}

TEST_F(UsbTransfersTest, ANodeThatLeadsNowhereAndAHeldInterfaceAreRefusedAndLeakNothing) {
  const int alive = FakeUsbWire::alive();
  bus::UsbMailboxes mail({});
  const auto nowhere = linux::UsbTransfers::open(-1, 0, mail, bench.clock);
  ASSERT_FALSE(nowhere.has_value());
  EXPECT_EQ(nowhere.error().code, Errc::NotFound);
  const auto held = linux::UsbTransfers::open(bench.wire.open_node(), 0, mail, bench.clock);
  ASSERT_FALSE(held.has_value());
  EXPECT_EQ(held.error().code, Errc::Busy);
  EXPECT_EQ(FakeUsbWire::alive(), alive);
}

}  // namespace
}  // namespace thimble::test
