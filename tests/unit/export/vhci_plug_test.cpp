#include "sim/export/vhci_plug.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <fstream>

#include "hal/linux/descriptor.hpp"
#include "sim/export/vhci_controller.hpp"
#include "tests/support/scripted_usb_model.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/export/export_bench.hpp"
#include "tests/unit/export/usbip_host.hpp"

namespace thimble::sim {
namespace {

using Bytes = UsbipHost::Bytes;

// As a kernel says it: linux drivers/usb/usbip/vhci_sysfs.c, port_show_vhci.
constexpr const char* kHeading = "hub port sta spd dev      sockfd local_busid\n";
std::string port(const std::string& hub, int number, int state) {
  return hub + "  000" + std::to_string(number) + " 00" + std::to_string(state) +
         " 000 00000000 000000 0-0\n";
}

TEST(FreeVhciPort, IsTheFirstOfTheSlowHubThatHasNothing) {
  EXPECT_EQ(free_vhci_port(kHeading + port("hs", 0, 6) + port("hs", 1, 5) + port("hs", 2, 4) +
                           port("hs", 3, 4)),
            2U);
}
TEST(FreeVhciPort, IsNoneOfThoseThatAreTakenOrFast) {
  EXPECT_EQ(free_vhci_port(kHeading + port("hs", 0, 6) + port("ss", 8, 4)), std::nullopt);
}
TEST(FreeVhciPort, IsNoneOfWhatIsNoList) {
  for (const char* text : {"", "\n\n", "hs", "hs x 4", "hs 0", "hs -", "\xff\xfe\0 hs"}) {
    EXPECT_EQ(free_vhci_port(text), std::nullopt) << text;
  }
}

class VhciControllerTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::string read(const std::string& name) const {
    std::ifstream file(folder_.path() / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  testing_support::TemporaryFolder folder_;
  VhciController sut_{folder_.path().string()};
};

TEST_F(VhciControllerTest, SaysPortSocketDeviceAndSpeed) {
  folder_.write("status", kHeading + port("hs", 0, 6) + port("hs", 1, 4));
  folder_.write("attach", "");
  EXPECT_TRUE(sut_.attach(17, 0x10001));
  EXPECT_EQ(read("attach"), "1 17 65537 2") << "2: full speed, linux/usb/ch9.h";
}
TEST_F(VhciControllerTest, SaysWhichModuleIsMissing) {
  const auto done = sut_.attach(17, 1);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::NotFound);
  EXPECT_NE(done.error().message.find("modprobe vhci-hcd"), std::string::npos);
}
TEST_F(VhciControllerTest, IsBusyWithADeviceAtEachPort) {
  folder_.write("status", kHeading + port("hs", 0, 6));
  folder_.write("attach", "");
  EXPECT_EQ(sut_.attach(17, 1).error().code, Errc::Busy);
  EXPECT_EQ(read("attach"), "");
}

// The kernel's end is in the test's hands.
class VhciPlugTest : public ::testing::Test {
 protected:
  Result<void> take(int socket, std::uint32_t device_id) {
    if (!refusal_.empty()) return fail(Errc::Permission, refusal_);
    kernel_ = linux::Descriptor(::dup(socket));
    device_id_ = device_id;
    return {};
  }
  // Frames run until so many bytes came, or the other end is closed.
  Bytes hear(std::size_t wanted) {
    Bytes heard;
    for (int frame = 0; frame < 200 && heard.size() < wanted && !is_hung_up_; ++frame) {
      bench_.run_frames(1);
      Bytes piece(4096);
      const ssize_t size = ::recv(kernel_.get(), piece.data(), piece.size(), MSG_DONTWAIT);
      is_hung_up_ = size == 0;
      if (size > 0) heard.insert(heard.end(), piece.begin(), piece.begin() + size);
    }
    return heard;
  }
  void say(const Bytes& bytes) const {
    EXPECT_EQ(::send(kernel_.get(), bytes.data(), bytes.size(), 0),
              static_cast<ssize_t>(bytes.size()));
  }
  Bytes read_bulk() {
    say(host_.read(test::ScriptedUsbModel::kBulkIn, 64));
    Bytes answer = hear(51);
    const auto reply = UsbipHost::take_reply(answer, true);
    return reply ? reply->data : Bytes{};
  }

  ExportBench bench_;
  boost::asio::io_context io_;
  std::shared_ptr<test::UsbModelScript> script_ = std::make_shared<test::UsbModelScript>();
  test::ScriptedUsbModel model_{script_};
  std::string refusal_;
  linux::Descriptor kernel_;
  std::uint32_t device_id_{0};
  bool is_hung_up_{false};
  UsbipHost host_;
  VhciPlug sut_{io_,
                model_,
                {model_.describe(), {}},
                bench_.surroundings(),
                [this](int socket, std::uint32_t id) { return take(socket, id); }};
};

TEST_F(VhciPlugTest, ServesTheKernelWithoutBeingAsked) {
  ASSERT_TRUE(sut_.plug());
  EXPECT_TRUE(sut_.is_attached());
  EXPECT_EQ(device_id_, 0x10001U) << "as in each message of the host";
  script_->to_send[test::ScriptedUsbModel::kBulkIn] = {{1, 2, 3}};
  EXPECT_EQ(read_bulk(), (Bytes{1, 2, 3}));
  EXPECT_TRUE(sut_.is_open());
}
TEST_F(VhciPlugTest, IsPluggedInOnce) {
  ASSERT_TRUE(sut_.plug());
  EXPECT_EQ(sut_.plug().error().code, Errc::Busy);
}
TEST_F(VhciPlugTest, UnpluggedHangsUpAndComesBackAsNew) {
  ASSERT_TRUE(sut_.plug());
  ASSERT_TRUE(sut_.unplug(Supply::Goes));
  EXPECT_TRUE(hear(1).empty());
  EXPECT_TRUE(is_hung_up_);
  is_hung_up_ = false;
  ASSERT_TRUE(sut_.plug());
  EXPECT_EQ(script_->power_cycles, 2) << "once when the plug was pulled, once now";
  script_->to_send[test::ScriptedUsbModel::kBulkIn] = {{4}};
  say(host_.read(test::ScriptedUsbModel::kBulkIn, 64));
  EXPECT_EQ(hear(49).size(), 49U);
}
TEST_F(VhciPlugTest, DetachedByTheKernelItWaitsForTheNextPlug) {
  ASSERT_TRUE(sut_.plug());
  kernel_ = linux::Descriptor();
  bench_.run_frames(2);
  EXPECT_FALSE(sut_.is_attached());
  EXPECT_TRUE(sut_.is_plugged()) << "nobody pulled it";
  ASSERT_TRUE(sut_.unplug(Supply::Goes));
  ASSERT_TRUE(sut_.plug());
  EXPECT_TRUE(sut_.is_attached());
}
TEST_F(VhciPlugTest, HangsUpOnWhoTakesNothingOfWhatItAskedFor) {
  ASSERT_TRUE(sut_.plug());
  say(host_.control({0x80, 6, 0, 1, 0, 0, 18, 0}));  // a host that may be idle for ever
  hear(48 + 18);
  constexpr std::size_t kTransfers = 16;
  constexpr std::size_t kBytes = UsbipSession::kMaxTransferBytes;
  script_->to_send[test::ScriptedUsbModel::kBulkIn].assign(kTransfers * kBytes / 64, Bytes(64, 7));
  for (std::size_t i = 0; i < kTransfers; ++i) {
    say(host_.read(test::ScriptedUsbModel::kBulkIn, kBytes));
  }
  bench_.run_frames(9000);
  EXPECT_TRUE(sut_.is_attached());
  Bytes some(2 * kBytes);
  ASSERT_GT(::recv(kernel_.get(), some.data(), some.size(), MSG_DONTWAIT), 0);
  bench_.run_frames(9000);
  EXPECT_TRUE(sut_.is_attached()) << "it took some";
  bench_.run_frames(2000);
  EXPECT_FALSE(sut_.is_attached());
  ASSERT_TRUE(sut_.unplug(Supply::Goes));
  ASSERT_TRUE(sut_.plug());
  script_->to_send[test::ScriptedUsbModel::kBulkIn] = {{4}};
  EXPECT_EQ(read_bulk(), Bytes{4});
}
TEST_F(VhciPlugTest, RefusedItIsNotPluggedIn) {
  refusal_ = "not for you";
  EXPECT_EQ(sut_.plug().error().message, refusal_);
  EXPECT_FALSE(sut_.is_plugged());
  bench_.run_frames(2);
  EXPECT_FALSE(sut_.is_attached());
  refusal_.clear();
  EXPECT_TRUE(sut_.plug());
}

}  // namespace
}  // namespace thimble::sim
