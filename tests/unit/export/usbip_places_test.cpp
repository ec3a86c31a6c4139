// Who has one of the few places of a USB/IP server, and for how long.
#include <array>
#include <vector>

#include "tests/unit/export/usbip_plug_fixture.hpp"

namespace thimble::sim {
namespace {

// `usbip attach` waits for no stranger who says nothing.
TEST_F(UsbipPlugTest, WhoHasAskedNothingForTheLongestGivesWayToWhoComesAnew) {
  std::vector<Tcp::socket> silent;
  for (std::size_t i = 0; i < UsbipPlug::kMostConnections; ++i) {
    silent.push_back(connect(*sut_));
    bench_.run_frames(1);
  }
  boost::system::error_code ignored;
  boost::asio::write(silent[0], boost::asio::buffer(UsbipHost::import().data(), 39), ignored);
  Tcp::socket host = connect(*sut_);
  EXPECT_EQ(ask(host, UsbipHost::import(), 320).size(), 320U);
  EXPECT_TRUE(sut_->is_attached());
  ask(silent[0], {}, 1);
  EXPECT_TRUE(is_hung_up_) << "part of a question is none";
  EXPECT_EQ(ask(silent[1], UsbipHost::devlist(), 12).size(), 12U) << "it has its place still";
}

// However many come, none of them is the one that is driven, and no more are kept than may be.
TEST_F(UsbipPlugTest, WhoHasTheDeviceGivesWayToNobody) {
  Tcp::socket host = connect(*sut_);
  ASSERT_EQ(ask(host, UsbipHost::import(), 320).size(), 320U);
  std::vector<Tcp::socket> silent;
  for (std::size_t i = 0; i < 5 * UsbipPlug::kMostConnections; ++i) {
    silent.push_back(connect(*sut_));
    bench_.run_frames(50);
  }
  EXPECT_TRUE(sut_->is_attached());
  EXPECT_EQ(ask(host, host_.control({0x80, 6, 0, 1, 0, 0, 18, 0}), 66).size(), 66U);
  std::size_t kept = 0;
  for (Tcp::socket& socket : silent) {
    boost::system::error_code error;
    std::array<std::uint8_t, 1> byte{};
    socket.read_some(boost::asio::buffer(byte), error);
    kept += error == boost::asio::error::would_block ? 1U : 0U;
  }
  EXPECT_EQ(kept, UsbipPlug::kMostConnections - 1);
}

// Four of them would keep everybody else out for ever.
TEST_F(UsbipPlugTest, HangsUpOnWhoAsksNothingOrTakesTheDeviceAndLeavesItAlone) {
  Tcp::socket host = connect(*sut_);
  ASSERT_EQ(ask(host, UsbipHost::import(), 320).size(), 320U);
  std::vector<Tcp::socket> idle;
  for (std::size_t i = 1; i < UsbipPlug::kMostConnections; ++i) idle.push_back(connect(*sut_));
  ASSERT_TRUE(ask(host, {}, 1).empty());          // 200 frames, in which all are accepted
  for (int second = 0; second <= 10; ++second) {  // a byte now and then is no question
    boost::system::error_code ignored;
    boost::asio::write(idle[0], boost::asio::buffer("\x01", 1), ignored);
    bench_.run_frames(1000);
  }
  for (Tcp::socket& socket : idle) {
    ask(socket, {}, 1);
    EXPECT_TRUE(is_hung_up_);
  }
  EXPECT_FALSE(sut_->is_attached()) << "its host never made a request";
  Tcp::socket next = connect(*sut_);
  EXPECT_EQ(ask(next, UsbipHost::import(), 320).size(), 320U);
}

TEST_F(UsbipPlugTest, LetsAHostBeIdleForEver) {
  Tcp::socket host = connect(*sut_);
  ask(host, UsbipHost::import(), 320);
  ask(host, host_.control({0x80, 6, 0, 1, 0, 0, 18, 0}), 48);
  bench_.run_frames(30'000);
  EXPECT_TRUE(sut_->is_attached());
}

}  // namespace
}  // namespace thimble::sim
