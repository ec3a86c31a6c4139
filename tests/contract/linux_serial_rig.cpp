// What the real bus does with a terminal, under the contract suite: the kernel's own terminals, a
// pseudo-terminal with the device at its master's end. In place of the bus's thread stands the
// test, so that what is asked of the kernel is the same in every run.
#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <string>
#include <utility>

#include "hal/linux/serial_transfers.hpp"
#include "sim/time/virtual_clock.hpp"
#include "tests/contract/serial_port_contract.hpp"

namespace thimble::test {
namespace {

using Bytes = SerialRig::Bytes;
using linux::Descriptor;
using linux::SerialTransfers;
constexpr int kPatience_ms = 10'000;  // for what the kernel is bound to do

// The device's end of a pseudo-terminal.
class PseudoTerminal {
 public:
  PseudoTerminal() : device_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
    EXPECT_EQ(::grantpt(device_.get()), 0);
    EXPECT_EQ(::unlockpt(device_.get()), 0);
    std::array<char, 64> name{};
    EXPECT_EQ(::ptsname_r(device_.get(), name.data(), name.size()), 0);
    node_ = name.data();
    // Keeps the terminal as it was set while nobody has it open.
    host_ = Descriptor(::open(node_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  }
  [[nodiscard]] const std::string& node() const { return node_; }
  void send(const Bytes& bytes) {
    EXPECT_EQ(::write(device_.get(), bytes.data(), bytes.size()),
              static_cast<ssize_t>(bytes.size()));
  }
  // Waits until `size` bytes have come in all.
  const Bytes& received(std::size_t size) {
    std::array<std::uint8_t, 4096> buffer{};
    while (received_.size() < size && device_.get() >= 0 && is_ready(device_.get())) {
      const ssize_t bytes = ::read(device_.get(), buffer.data(), buffer.size());
      if (bytes <= 0) break;
      received_.insert(received_.end(), buffer.begin(), buffer.begin() + bytes);
    }
    return received_;
  }
  // Whether the host finds anything to read.
  [[nodiscard]] bool has_arrived() const { return is_ready(host_.get()); }
  void set_deaf(bool is_deaf) { EXPECT_EQ(::tcflow(host_.get(), is_deaf ? TCOOFF : TCOON), 0); }
  void unplug() { device_ = Descriptor(); }

 private:
  static bool is_ready(int node) {
    pollfd watched{node, POLLIN, 0};
    return ::poll(&watched, 1, kPatience_ms) == 1;
  }

  Descriptor device_;
  Descriptor host_;
  std::string node_;
  Bytes received_;
};

class LinuxSerialRig final : public SerialRig {
 public:
  LinuxSerialRig() : transfers_(SerialTransfers::open(line_.node(), {}, mail_, clock_).value()) {}
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
  PseudoTerminal line_;
  bus::SerialMailboxes mail_;
  std::unique_ptr<SerialTransfers> transfers_;
  std::uint64_t sent_{0};
};

std::unique_ptr<SerialRig> make() { return std::make_unique<LinuxSerialRig>(); }

INSTANTIATE_TEST_SUITE_P(Linux, SerialPortContract,
                         testing::Values(SerialRigFactory{"SerialTransfers", &make}),
                         serial_rig_name);

struct SerialTransfersTest : testing::Test {
  sim::VirtualClock clock;
  PseudoTerminal line;
  bus::SerialMailboxes mail;

  Result<std::unique_ptr<SerialTransfers>> open(std::uint32_t bit_per_s = 115'200) {
    return SerialTransfers::open(line.node(), {bit_per_s}, mail, clock);
  }
};

TEST_F(SerialTransfersTest, TheRateIsThatOfTheLineAndOthersAreRefused) {
  for (const auto& [rate, code] : std::initializer_list<std::pair<std::uint32_t, speed_t>>{
           {38'400, B38400}, {115'200, B115200}, {3'000'000, B3000000}}) {
    const auto sut = open(rate);
    ASSERT_TRUE(sut.has_value()) << rate;
    termios settings{};
    EXPECT_EQ(::tcgetattr((*sut)->node()->get(), &settings), 0);
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
  EXPECT_EQ(::ioctl((*sut)->node()->get(), TIOCGEXCL, &is_exclusive), 0);
  EXPECT_EQ(is_exclusive, 1);
  const Descriptor shared(::dup((*sut)->node()->get()));  // a guard's, which may outlive it
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

TEST_F(SerialTransfersTest, WhatIsNoTerminalIsRefused) {
  const auto nowhere = SerialTransfers::open(line.node() + "0", {}, mail, clock);
  ASSERT_FALSE(nowhere.has_value());
  EXPECT_EQ(nowhere.error().code, Errc::NotFound);
  const auto file = SerialTransfers::open("/dev/null", {}, mail, clock);
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

}  // namespace
}  // namespace thimble::test
