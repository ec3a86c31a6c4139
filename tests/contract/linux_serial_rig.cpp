// What the real bus does with a terminal, under the contract suite: the kernel's own terminals, a
// pseudo-terminal with the device at its master's end. In place of the bus's thread stands the
// test, so that what is asked of the kernel is the same in every run.
#include <fcntl.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string>
#include <thread>
#include <utility>

#include "hal/linux/event_fd.hpp"
#include "hal/linux/monotonic_clock.hpp"
#include "hal/linux/serial_port.hpp"
#include "hal/linux/serial_transfers.hpp"
#include "sim/time/virtual_clock.hpp"
#include "tests/contract/pseudo_terminal.hpp"
#include "tests/contract/serial_port_contract.hpp"
#include "tests/support/allocation_count.hpp"

namespace thimble::test {
namespace {

using Bytes = SerialRig::Bytes;
using linux::Descriptor;
using linux::SerialTransfers;

class LinuxSerialRig final : public SerialRig {
 public:
  LinuxSerialRig()
      : transfers_(SerialTransfers::open(line_.node(), {}, mail_, clock_, kernel_).value()) {}
  bus::SerialPort& port() override { return mail_; }
  void close_port() override { transfers_.reset(); }
  void device_sends(const Bytes& bytes) override {
    sent_ += bytes.size();
    line_.send(bytes);
  }
  Bytes received_by_device() override { return line_.received(mail_.counters().bytes_out); }
  void set_deaf(bool is_deaf) override { line_.set_deaf(is_deaf); }
  void unplug() override { line_.unplug(); }
  void run_for(Duration duration) override {
    if (transfers_ != nullptr) {
      static_cast<void>(transfers_->send());
      do {
        transfers_->receive();
      } while (!mail_.is_disconnected() && mail_.counters().bytes_in < sent_ &&
               line_.has_arrived());
      static_cast<void>(transfers_->send());
      // The kernel's own thread carries it over, at any time, and a closing throws away what waits.
      static_cast<void>(line_.received(mail_.counters().bytes_out));
    }
    clock_.run_for(duration);
  }

 private:
  sim::VirtualClock clock_;
  linux::KernelCalls kernel_;
  PseudoTerminal line_;
  bus::SerialMailboxes mail_;
  std::unique_ptr<SerialTransfers> transfers_;
  std::uint64_t sent_{0};
};

std::unique_ptr<SerialRig> make() { return std::make_unique<LinuxSerialRig>(); }

INSTANTIATE_TEST_SUITE_P(Linux, SerialPortContract,
                         testing::Values(SerialRigFactory{"SerialTransfers", &make}),
                         serial_rig_name);

// The kernel, but for how many bytes it says that it still has: a pseudo-terminal hands over at
// once.
class FullKernel final : public linux::DeviceCalls {
 public:
  std::ptrdiff_t write(int node, std::span<const std::uint8_t> bytes) noexcept override {
    if (room == 0) {
      errno = EAGAIN;
      return -1;
    }
    const ssize_t written = kernel_.write(node, bytes.first(std::min(room, bytes.size())));
    if (written > 0) room -= static_cast<std::size_t>(written);
    return written;
  }
  int control(int node, unsigned long request, void* argument) noexcept override {
    if (request != TIOCOUTQ || !is_answered_here) return kernel_.control(node, request, argument);
    ++asked;
    if (waiting < 0) return -1;
    *static_cast<int*>(argument) = waiting;
    return 0;
  }

  bool is_gone(int node) noexcept override { return kernel_.is_gone(node); }

  std::size_t room{1'000'000};  // for bytes, until it refuses more
  bool is_answered_here{false};
  int waiting{0};  // below 0: cannot tell
  int asked{0};

 private:
  linux::KernelCalls kernel_;
};

struct SerialTransfersTest : testing::Test {
  sim::VirtualClock clock;
  FullKernel kernel;
  PseudoTerminal line;
  bus::SerialMailboxes mail;

  Result<std::unique_ptr<SerialTransfers>> open(std::uint32_t bit_per_s = 115'200) {
    return SerialTransfers::open(line.node(), {bit_per_s}, mail, clock, kernel);
  }
};

TEST_F(SerialTransfersTest, TheRateIsThatOfTheLineAndOthersAreRefused) {
  for (const auto& [rate, code] : std::initializer_list<std::pair<std::uint32_t, speed_t>>{
           {38'400, B38400}, {115'200, B115200}, {3'000'000, B3000000}}) {
    const auto sut = open(rate);
    ASSERT_TRUE(sut.has_value()) << rate;
    termios settings{};
    EXPECT_EQ(::tcgetattr((*sut)->node(), &settings), 0);
    EXPECT_EQ(::cfgetospeed(&settings), code);
  }
  for (const std::uint32_t rate : {0U, 134U, 115'201U}) {
    const auto sut = open(rate);
    ASSERT_FALSE(sut.has_value()) << rate;
    EXPECT_EQ(sut.error().code, Errc::InvalidArgument);
  }
}

TEST_F(SerialTransfersTest, NoFlowControlIsLeftOfWhoeverHadItBefore) {
  const Descriptor before(::open(line.node().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  termios settings{};
  ASSERT_EQ(::tcgetattr(before.get(), &settings), 0);
  settings.c_iflag |= IXON | IXOFF | IXANY | INPCK;
  settings.c_cflag |= CRTSCTS;
  ASSERT_EQ(::tcsetattr(before.get(), TCSANOW, &settings), 0);
  const auto sut = open();
  ASSERT_TRUE(sut.has_value());
  ASSERT_EQ(::tcgetattr(before.get(), &settings), 0);
  EXPECT_EQ(settings.c_iflag, 0U);
  EXPECT_EQ(settings.c_cflag & CRTSCTS, 0U);
}

TEST_F(SerialTransfersTest, TheNodeIsLockedUntilItIsClosed) {
  auto sut = open();
  ASSERT_TRUE(sut.has_value());
  const auto second = open();
  ASSERT_FALSE(second.has_value());
  EXPECT_EQ(second.error().code, Errc::Busy);
  EXPECT_NE(second.error().message.find(line.node()), std::string::npos);
  int is_exclusive = 0;
  EXPECT_EQ(::ioctl((*sut)->node(), TIOCGEXCL, &is_exclusive), 0);
  EXPECT_EQ(is_exclusive, 1);
  const Descriptor shared(::dup((*sut)->node()));  // a guard's, which may outlive it
  sut->reset();
  EXPECT_TRUE(open().has_value());
}

TEST_F(SerialTransfersTest, WhatTheKernelHadBeforeIsDiscarded) {
  { const auto raw = open(); }  // else the terminal would keep the bytes until a newline
  line.send({1, 2, 3});
  ASSERT_TRUE(line.has_arrived());
  const auto sut = open();
  line.send({4});
  ASSERT_TRUE(line.has_arrived());
  (*sut)->receive();
  EXPECT_EQ(mail.counters().bytes_in, 1U);
}

TEST_F(SerialTransfersTest, ADeviceThatFloodsIsReadSoOftenAMillisecondAndNothingOfItIsLost) {
  const auto sut = open();
  const auto never = linux::EventFd::create();
  const auto send_and_receive = [&] {
    line.send({1});
    ASSERT_TRUE(line.has_arrived());
    (*sut)->receive();
  };
  for (int window = 1; window <= 3; ++window) {
    const std::uint64_t before = mail.counters().bytes_in;
    const auto most = static_cast<std::uint64_t>(SerialTransfers::kMostReads);
    for (std::uint64_t i = 0; i < most; ++i) send_and_receive();
    EXPECT_EQ(mail.counters().bytes_in, before + most);
    send_and_receive();
    EXPECT_EQ(mail.counters().bytes_in, before + most) << "it rests";
    const auto ready = (*sut)->wait((*never)->fd());  // not for ever, and not for these bytes
    EXPECT_FALSE(ready.has_bytes || ready.is_woken);
    clock.run_for(SerialTransfers::kReadWindow);
    EXPECT_TRUE((*sut)->wait((*never)->fd()).has_bytes);
    (*sut)->receive();
    EXPECT_EQ(mail.counters().bytes_in, before + most + 1);
    clock.run_for(SerialTransfers::kReadWindow);
  }
}

TEST_F(SerialTransfersTest, WhileItRestsItIsWokenAndWritesAsEver) {
  const auto sut = open();
  const auto event = linux::EventFd::create();
  for (int i = 0; i <= SerialTransfers::kMostReads; ++i) {
    line.send({1});
    ASSERT_TRUE(line.has_arrived());
    (*sut)->receive();
  }
  (*event)->signal();
  const auto ready = (*sut)->wait((*event)->fd());
  EXPECT_TRUE(ready.is_woken);
  EXPECT_FALSE(ready.has_bytes);
  EXPECT_EQ(mail.submit(std::array<std::uint8_t, 1>{7}), IoStatus::Ok);
  EXPECT_TRUE((*sut)->send());
}

TEST_F(SerialTransfersTest, WhatIsNoTerminalIsRefused) {
  const auto nowhere = SerialTransfers::open(line.node() + "0", {}, mail, clock, kernel);
  ASSERT_FALSE(nowhere.has_value());
  EXPECT_EQ(nowhere.error().code, Errc::NotFound);
  const auto file = SerialTransfers::open("/dev/null", {}, mail, clock, kernel);
  ASSERT_FALSE(file.has_value());
  EXPECT_EQ(file.error().code, Errc::System);
}

TEST_F(SerialTransfersTest, TheLastMessageIsSentWithoutAnybodyWaitingForTheDeviceForEver) {
  const auto sut = open();
  line.set_deaf(true);
  EXPECT_EQ(mail.submit(Bytes{1, 2}), IoStatus::Ok);
  (*sut)->send_last();
  EXPECT_EQ(mail.counters().messages_out, 0U);
  line.set_deaf(false);
  EXPECT_EQ(mail.submit(Bytes{3, 4}), IoStatus::Backlogged);
  (*sut)->send_last();
  EXPECT_EQ(line.received(4), (Bytes{1, 2, 3, 4})) << "the one under way, then the newest";
}

TEST_F(SerialTransfersTest, WhileTheKernelHasBytesOfAnEarlierMessageTheNewestWaitsOutside) {
  const auto sut = open();
  kernel.is_answered_here = true;
  kernel.waiting = 1;
  EXPECT_TRUE((*sut)->send() && kernel.asked == 0) << "nothing is to be sent";
  EXPECT_EQ(mail.submit(Bytes{1, 2}), IoStatus::Ok);
  EXPECT_FALSE((*sut)->send());
  EXPECT_EQ(mail.submit(Bytes{3, 4}), IoStatus::Backlogged);
  EXPECT_FALSE((*sut)->send());
  EXPECT_EQ(mail.counters().messages_out, 0U);
  kernel.waiting = 0;
  EXPECT_TRUE((*sut)->send());
  EXPECT_EQ(line.received(2), (Bytes{3, 4})) << "the older one was never the kernel's";
}

TEST_F(SerialTransfersTest, WhileTheKernelHasBytesItIsAskedAgainWithoutAnyEvent) {
  const auto sut = open();
  kernel.is_answered_here = true;
  kernel.waiting = 1;
  EXPECT_EQ(mail.submit(Bytes{1}), IoStatus::Ok);
  EXPECT_FALSE((*sut)->send());
  const auto never = linux::EventFd::create();
  const auto ready = (*sut)->wait((*never)->fd());  // else for ever
  EXPECT_FALSE(ready.is_woken || ready.has_bytes);
  kernel.waiting = 0;
  EXPECT_TRUE((*sut)->send());
}

// What is left of a message must go even though the kernel has its beginning.
TEST_F(SerialTransfersTest, AMessageThatIsPartlyOutIsNotHeldUpByItself) {
  const auto sut = open();
  kernel.is_answered_here = true;
  kernel.room = 1;
  EXPECT_EQ(mail.submit(Bytes{1, 2, 3}), IoStatus::Ok);
  EXPECT_FALSE((*sut)->send());
  EXPECT_EQ(mail.submit(Bytes{4}), IoStatus::Backlogged);
  kernel.waiting = 1;
  kernel.room = 10;
  EXPECT_FALSE((*sut)->send()) << "the next one waits";
  EXPECT_EQ(line.received(3), (Bytes{1, 2, 3}));
  kernel.waiting = 0;
  EXPECT_TRUE((*sut)->send());
  EXPECT_EQ(line.received(4), (Bytes{1, 2, 3, 4}));
}

TEST_F(SerialTransfersTest, ATerminalThatCannotTellIsWrittenTo) {
  const auto sut = open();
  kernel.is_answered_here = true;
  kernel.waiting = -1;
  EXPECT_EQ(mail.submit(Bytes{1, 2}), IoStatus::Ok);
  EXPECT_TRUE((*sut)->send());
  EXPECT_EQ(line.received(2), (Bytes{1, 2}));
  EXPECT_EQ(kernel.asked, 1);
}

TEST_F(SerialTransfersTest, SaysWhatItsWaitEndedFor) {
  const auto sut = open();
  const auto event = linux::EventFd::create();
  (*event)->signal();
  EXPECT_TRUE((*sut)->wait((*event)->fd()).is_woken);
  (*event)->drain();
  line.send({7});
  const auto ready = (*sut)->wait((*event)->fd());
  EXPECT_TRUE(ready.has_bytes && !ready.is_woken);
  (*sut)->receive();
  EXPECT_EQ(mail.counters().bytes_in, 1U);
  line.unplug();
  EXPECT_TRUE((*sut)->wait((*event)->fd()).has_bytes);
  (*sut)->receive();
  EXPECT_TRUE(mail.is_disconnected());
}

TEST_F(SerialTransfersTest, TheLastMessageWaitsForADeviceThatTakesNothingForAWhileOnly) {
  const auto sut = open();
  kernel.is_answered_here = true;
  kernel.waiting = 1;
  EXPECT_EQ(mail.submit(Bytes{1, 2}), IoStatus::Ok);
  (*sut)->send_last();
  EXPECT_EQ(kernel.asked, 20);
  EXPECT_EQ(mail.counters().messages_out, 0U);
}

// With the bus's own thread, on a real terminal: waits for what must come, as long as it takes.
struct SerialPortTest : testing::Test {
  linux::MonotonicClock clock;
  PseudoTerminal line;
  std::unique_ptr<linux::SerialPort> sut = [this] {
    return linux::SerialPort::open(line.node(), {"serial:X"}, {}, {clock, {}, {}}).value();
  }();

  // Bytes that the thread brought, until there are `size` or it says that the port is gone.
  Bytes read(std::size_t size) {
    Bytes all;
    const MonotonicTime deadline =
        clock.now() + std::chrono::milliseconds(PseudoTerminal::kPatience_ms);
    while (all.size() < size && clock.now() < deadline) {
      bus::SerialChunk chunk;
      status = sut->read(chunk);
      if (status == IoStatus::Disconnected) break;
      if (status != IoStatus::Ok) {
        std::this_thread::yield();
        continue;
      }
      all.insert(all.end(), chunk.payload().begin(), chunk.payload().end());
    }
    return all;
  }

  IoStatus status{IoStatus::NoData};
};

TEST_F(SerialPortTest, ItsThreadCarriesBytesBothWays) {
  Bytes sent;
  for (std::uint8_t round = 0; round < 50; ++round) {
    line.send({round, 1, 2});
    EXPECT_EQ(read(3), (Bytes{round, 1, 2}));
    EXPECT_NE(sut->submit(Bytes{round, 9}), IoStatus::Disconnected);
    sent.insert(sent.end(), {round, 9});
    ASSERT_EQ(line.received(sent.size()), sent);
  }
  EXPECT_EQ(sut->counters().bytes_in, 150U);
}

TEST_F(SerialPortTest, AnExchangeAllocatesNothingInTheThreadOfTheServo) {
  const Bytes command{1, 2, 3};
  bus::SerialChunk chunk;
  std::uint64_t allocated = 0;
  for (int tick = 0; tick < 200; ++tick) {
    line.send({4, 5, 6});
    const MonotonicTime deadline =
        clock.now() + std::chrono::milliseconds(PseudoTerminal::kPatience_ms);
    const std::uint64_t before = allocation_count();
    static_cast<void>(sut->submit(command));
    while (sut->read(chunk) != IoStatus::Ok && clock.now() < deadline) std::this_thread::yield();
    allocated += allocation_count() - before;
    ASSERT_GT(chunk.sequence, 0U);
  }
  EXPECT_EQ(allocated, 0U);
  EXPECT_EQ(sut->counters().bytes_in, 600U);
}

TEST_F(SerialPortTest, ALineThatIsPulledEndsItAndItsThreadCanBeJoined) {
  line.unplug();
  EXPECT_TRUE(read(1).empty());
  EXPECT_EQ(status, IoStatus::Disconnected);
  EXPECT_EQ(sut->submit(Bytes{1}), IoStatus::Disconnected);
  sut.reset();
}

TEST_F(SerialPortTest, ClosingEndsItsThreadAndLeavesTheNodeToOthers) {
  const std::weak_ptr<const linux::SharedDevice> shared = sut->shared();
  EXPECT_FALSE(shared.expired());
  const auto open = [&] {
    return linux::SerialPort::open(line.node(), {"serial:X"}, {}, {clock, {}, {}});
  };
  const auto second = open();
  ASSERT_FALSE(second.has_value());
  EXPECT_EQ(second.error().code, Errc::Busy);
  sut.reset();
  EXPECT_TRUE(shared.expired());
  EXPECT_TRUE(open().has_value());
}

}  // namespace
}  // namespace thimble::test
