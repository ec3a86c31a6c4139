#include "sim/export/usbip_plug.hpp"

#include <gtest/gtest.h>

#include <boost/asio/write.hpp>
#include <memory>

#include "sim/export/hid_on_usb.hpp"
#include "tests/support/scripted_hid_model.hpp"
#include "tests/unit/export/usbip_plug_fixture.hpp"

namespace thimble::sim {
namespace {

using std::chrono::milliseconds;
using Tcp = boost::asio::ip::tcp;

// A Falcon that is offered loaded, say, has its firmware until somebody pulls the plug.
TEST_F(UsbipPlugTest, PlugsADeviceInAsItWasMade) {
  EXPECT_EQ(script_->power_cycles, 0);
  ASSERT_TRUE(sut_->unplug(Supply::Goes));
  EXPECT_EQ(script_->power_cycles, 1);
  bench_.run_frames(1000);
  ASSERT_TRUE(sut_->plug());
  EXPECT_EQ(script_->power_cycles, 2) << "its power came this very moment";
}

TEST_F(UsbipPlugTest, ItsCableAlonePulledTheDeviceKeepsItsPower) {
  ASSERT_TRUE(sut_->unplug(Supply::Stays));
  bench_.run_frames(10);
  ASSERT_TRUE(sut_->plug());
  EXPECT_EQ(script_->power_cycles, 0);
  ASSERT_TRUE(sut_->unplug(Supply::Stays));
  ASSERT_TRUE(sut_->unplug(Supply::Goes)) << "after the cable the supply";
  EXPECT_FALSE(sut_->unplug(Supply::Goes));
  ASSERT_TRUE(sut_->plug());
  EXPECT_EQ(script_->power_cycles, 2);
  Tcp::socket host = connect(*sut_);
  EXPECT_EQ(ask(host, UsbipHost::import(), 320).size(), 320U);
}

TEST_F(UsbipPlugTest, ServesAHostThatAttaches) {
  Tcp::socket host = connect(*sut_);
  EXPECT_EQ(ask(host, UsbipHost::import(), 320).size(), 320U);
  EXPECT_TRUE(sut_->is_attached());
  EXPECT_FALSE(sut_->is_open()) << "nobody there uses it";
  script_->to_send[test::ScriptedUsbModel::kBulkIn] = {{1, 2, 3}};
  Bytes answer = ask(host, host_.read(test::ScriptedUsbModel::kBulkIn, 64), 51);
  EXPECT_EQ(UsbipHost::take_reply(answer, true)->data, (Bytes{1, 2, 3}));
  EXPECT_EQ(sut_->counters().to_host, 1U);
  EXPECT_TRUE(sut_->is_open());
  bench_.run_frames(100);
  EXPECT_FALSE(sut_->is_open());
}

TEST_F(UsbipPlugTest, NeedsAFrameAndARoundInWhichTheDeviceMaySaySomething) {
  EXPECT_EQ(sut_->next_needed(), MonotonicTime{milliseconds(1)}) << "nobody has it";
  Tcp::socket host = connect(*sut_);
  ask(host, UsbipHost::import(), 320);
  const MonotonicTime frame = bench_.clock.now();
  EXPECT_EQ(sut_->next_needed(), frame + milliseconds(1)) << "nobody asks it anything";
  ask(host, host_.read(test::ScriptedUsbModel::kBulkIn, 64), 51);
  EXPECT_EQ(sut_->next_needed(), bench_.clock.now() + sut_->round_period()) << "it says no when";
}

TEST_F(UsbipPlugTest, HearsTheHostWhileItWaits) {
  Tcp::socket host = connect(*sut_);
  ask(host, UsbipHost::import(), 320);
  EXPECT_FALSE(sut_->wait_for_kernel(bench_.machine.now()));
  boost::asio::write(host, boost::asio::buffer(host_.read(test::ScriptedUsbModel::kBulkIn, 64)));
  EXPECT_TRUE(sut_->wait_for_kernel(bench_.machine.now() + std::chrono::seconds(5)));
}

TEST_F(UsbipPlugTest, WhoWaitsForWhatTheDeviceDoesNotHaveYetNeedsNoRound) {
  Tcp::socket host = connect(*sut_);
  ask(host, UsbipHost::import(), 320);
  script_->unchanged_until = bench_.clock.now() + milliseconds(7);
  // Real time: long enough where it must hear, short where it must not.
  const auto hears = [&](const Bytes& words, Duration most = std::chrono::seconds(5)) {
    boost::asio::write(host, boost::asio::buffer(words));
    return sut_->wait_for_kernel(bench_.machine.now() + most);
  };
  EXPECT_FALSE(hears(host_.read(test::ScriptedUsbModel::kBulkIn, 64), milliseconds(20)));
  EXPECT_TRUE(hears(host_.write(test::ScriptedUsbModel::kBulkOut, {1, 2})));
  EXPECT_EQ(sut_->next_needed(), bench_.clock.now() + sut_->round_period());
  bench_.run_frames(1);
  EXPECT_EQ(script_->received[test::ScriptedUsbModel::kBulkOut], (std::vector<Bytes>{{1, 2}}));
  EXPECT_FALSE(hears(host_.read(test::ScriptedUsbModel::kBulkIn, 64), milliseconds(20)));
  EXPECT_TRUE(hears(host_.control({0x80, 6, 0, 1, 0, 0, 18, 0})));
  script_->to_send[test::ScriptedUsbModel::kBulkIn] = {{3}, {4}};
  bench_.run_frames(7);
  EXPECT_EQ(sut_->counters().to_host, 2U) << "both that had been read meanwhile";
  EXPECT_TRUE(hears(host_.unlink(4711)));
}

TEST_F(UsbipPlugTest, WhoComesWhileItWaitsIsAnsweredAsEver) {
  Tcp::socket host = connect(*sut_);
  bench_.run_frames(1);
  boost::asio::write(host, boost::asio::buffer(UsbipHost::import()));
  EXPECT_TRUE(sut_->wait_for_kernel(bench_.machine.now() + std::chrono::seconds(5)));
  EXPECT_EQ(ask(host, {}, 320).size(), 320U);
  EXPECT_TRUE(sut_->is_attached());
}

TEST_F(UsbipPlugTest, WhoSaysNoMessageWhileItWaitsIsHungUpOn) {
  Tcp::socket host = connect(*sut_);
  ask(host, UsbipHost::import(), 320);
  boost::asio::write(host, boost::asio::buffer(Bytes(48, 0xff)));
  EXPECT_TRUE(sut_->wait_for_kernel(bench_.machine.now() + std::chrono::seconds(5)));
  EXPECT_EQ(sut_->counters().malformed, 1U);
  ask(host, {}, 1);
  EXPECT_TRUE(is_hung_up_);
  EXPECT_FALSE(sut_->is_attached());
}

// A message that never ends, of which a byte comes whenever somebody looks at the time.
class DrippingClock final : public Clock {
 public:
  [[nodiscard]] MonotonicTime now() const noexcept override {
    boost::system::error_code error;
    if (host != nullptr) drops += host->write_some(boost::asio::buffer("", 1), error);
    return {};
  }
  Duration sleep_until(MonotonicTime) noexcept override { return {}; }
  Tcp::socket* host{nullptr};
  mutable std::size_t drops{0};
};

TEST_F(UsbipPlugTest, HearsWhoeverTalksWithoutAnEndNoLongerThanIsWaited) {
  DrippingClock machine;
  PlugSurroundings around = bench_.surroundings();
  around.machine = &machine;
  auto plug = UsbipPlug::listen(io_, 0, model_, {model_.describe(), {}}, around);
  ASSERT_TRUE(plug);
  ASSERT_TRUE((*plug)->plug());
  Tcp::socket host = connect(**plug);
  ask(host, UsbipHost::import(), 320);
  machine.host = &host;
  EXPECT_FALSE((*plug)->wait_for_kernel(machine.now()));
  EXPECT_LT(machine.drops, 10U);
}

TEST_F(UsbipPlugTest, WhatAHostSaysBeforeItHangsUpIsDoneStill) {
  Tcp::socket host = connect(*sut_);
  ask(host, UsbipHost::import(), 320);
  const Bytes zero = host_.write(test::ScriptedUsbModel::kBulkOut, {0});
  boost::asio::write(host, boost::asio::buffer(zero));
  host.close();
  bench_.run_frames(2);
  EXPECT_EQ(script_->received[test::ScriptedUsbModel::kBulkOut], (std::vector<Bytes>{{0}}));
  EXPECT_FALSE(sut_->is_attached());
}

TEST_F(UsbipPlugTest, NothingIsDoneForWhomItSaidWithNonsenseBehindIt) {
  Tcp::socket host = connect(*sut_);
  ask(host, UsbipHost::import(), 320);
  Bytes words = host_.write(test::ScriptedUsbModel::kBulkOut, {1});
  words.insert(words.end(), 48, 0xff);
  ask(host, words, 1);
  EXPECT_TRUE(is_hung_up_);
  EXPECT_TRUE(script_->received[test::ScriptedUsbModel::kBulkOut].empty());
}

TEST_F(UsbipPlugTest, ARoundThatIsLeftOutDoesNothing) {
  Tcp::socket host = connect(*sut_);
  ask(host, UsbipHost::import(), 320);
  script_->to_send[test::ScriptedUsbModel::kBulkIn] = {{1, 2, 3}};
  boost::asio::write(host, boost::asio::buffer(host_.read(test::ScriptedUsbModel::kBulkIn, 64)));
  sut_->leave_out_until(bench_.clock.now() + milliseconds(5));
  bench_.run_frames(4);
  EXPECT_EQ(sut_->counters().to_host, 0U);
  EXPECT_EQ(ask(host, {}, 51).size(), 51U);
}

TEST_F(UsbipPlugTest, IsAttachedToOneHostAtATime) {
  Tcp::socket host = connect(*sut_);
  EXPECT_EQ(ask(host, UsbipHost::import(), 320).size(), 320U);
  Tcp::socket other = connect(*sut_);
  EXPECT_EQ(ask(other, UsbipHost::import(), 8), (Bytes{1, 0x11, 0, 3, 0, 0, 0, 1}));
  host.close();
  bench_.run_frames(5);
  EXPECT_FALSE(sut_->is_attached());
  Tcp::socket next = connect(*sut_);
  EXPECT_EQ(ask(next, UsbipHost::import(), 320).size(), 320U);
}

// To look for others in each frame would be the dearest thing that a driven device does.
TEST_F(UsbipPlugTest, LetsOthersWaitForAsMuchAsFiftyFramesWhileAHostHasIt) {
  Tcp::socket host = connect(*sut_);
  ask(host, UsbipHost::import(), 320);
  for (int other = 0; other < 100; ++other) {
    Tcp::socket client = connect(*sut_);
    boost::asio::write(client, boost::asio::buffer(UsbipHost::devlist()));
    bench_.run_frames(52);  // and one to be asked in, one to answer
    EXPECT_GT(client.available(), 0U);
    bench_.run_frames(1);
  }
}

// Or clients that ask for the list again and again keep the device from everybody.
TEST_F(UsbipPlugTest, HangsUpOnceItGaveAListOrRefusedTheDevice) {
  for (const Bytes& question : {UsbipHost::devlist(), UsbipHost::import("1-2")}) {
    Tcp::socket client = connect(*sut_);
    EXPECT_GE(ask(client, question, 8).size(), 8U);
    ask(client, {}, 1);
    EXPECT_TRUE(is_hung_up_);
  }
  std::vector<Tcp::socket> again;
  for (std::size_t i = 0; i < 3 * UsbipPlug::kMostConnections; ++i) {
    again.push_back(connect(*sut_));
    EXPECT_EQ(ask(again.back(), UsbipHost::devlist(), 328).size(), 328U);
  }
  Tcp::socket host = connect(*sut_);
  EXPECT_EQ(ask(host, UsbipHost::import(), 320).size(), 320U);
}

TEST_F(UsbipPlugTest, UnpluggedItHangsUpAndOffersNothing) {
  Tcp::socket host = connect(*sut_);
  ask(host, UsbipHost::import(), 320);
  const int before = script_->power_cycles;
  ASSERT_TRUE(sut_->unplug(Supply::Goes));
  EXPECT_EQ(script_->power_cycles, before + 1);
  ask(host, {}, 1);
  EXPECT_TRUE(is_hung_up_);
  const auto ask_anew = [&](const Bytes& question, std::size_t wanted) {
    Tcp::socket again = connect(*sut_);
    return ask(again, question, wanted).size();
  };
  EXPECT_EQ(ask_anew(UsbipHost::import(), 8), 8U);
  EXPECT_EQ(ask_anew(UsbipHost::devlist(), 12), 12U);
  ASSERT_TRUE(sut_->plug());
  EXPECT_EQ(ask_anew(UsbipHost::import(), 320), 320U);
  EXPECT_EQ(sut_->plug().error().code, Errc::Busy);
}

TEST_F(UsbipPlugTest, HangsUpOnWhoSaysNonsense) {
  Tcp::socket host = connect(*sut_);
  ask(host, Bytes(64, 0xEE), 1);
  EXPECT_TRUE(is_hung_up_);
  EXPECT_EQ(sut_->counters().malformed, 1U);
}

// A kernel reads data behind the answer of a read only: any others would be taken for a header.
TEST_F(UsbipPlugTest, AnswersNoDataToAWriteWhateverItsSetupAsksFor) {
  Tcp::socket host = connect(*sut_);
  ASSERT_EQ(ask(host, UsbipHost::import(), 320).size(), 320U);
  Bytes message = host_.control({0, 9, 0, 0, 0, 0, 0, 0}, Bytes(18, 0));
  const Bytes asks_for_descriptor{0x80, 6, 0, 1, 0, 0, 18, 0};
  std::copy(asks_for_descriptor.begin(), asks_for_descriptor.end(), message.begin() + 40);
  const Bytes answer = ask(host, message, 49);
  ASSERT_EQ(answer.size(), 48U) << "a header alone";
  EXPECT_EQ(static_cast<std::int32_t>(UsbipHost::get(answer, 20)), -EPIPE);
  EXPECT_EQ(ask(host, host_.control({0x80, 6, 0, 1, 0, 0, 18, 0}), 66).size(), 66U);
}

TEST_F(UsbipPlugTest, RefusesAPortThatIsTaken) {
  const auto other = UsbipPlug::listen(io_, sut_->port(), model_, {}, bench_.surroundings());
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, Errc::Busy);
}

TEST_F(UsbipPlugTest, HasRoundsOfEighthsOnlyWhereThereIsBulk) {
  EXPECT_EQ(sut_->round_period(), std::chrono::microseconds(125));
  UsbPersona persona{model_.describe(), {}};
  std::erase_if(persona.info.endpoints,
                [](const auto& e) { return e.kind != bus::UsbTransferKind::Interrupt; });
  EXPECT_EQ(make(model_, persona)->round_period(), std::chrono::milliseconds(1));
}

class HidOnUsbTest : public UsbipPlugTest {
 protected:
  HidOnUsbTest() {
    plug_ = make(wrapped_, wrapped_.persona(hid_.describe()));
    EXPECT_TRUE(plug_->plug());
    host_socket_.emplace(connect(*plug_));
    ask(*host_socket_, UsbipHost::import(), 320);
  }
  UsbipHost::Reply transfer(const Bytes& message, bool has_data) {
    Bytes answer = ask(*host_socket_, message, 48);
    const auto reply = UsbipHost::take_reply(answer, has_data);
    EXPECT_TRUE(reply);
    return reply.value_or(UsbipHost::Reply{});
  }

  std::shared_ptr<test::HidModelScript> hid_script_ = std::make_shared<test::HidModelScript>();
  test::ScriptedHidModel hid_{hid_script_};
  HidOnUsb wrapped_{hid_};
  std::unique_ptr<UsbipPlug> plug_;
  std::optional<Tcp::socket> host_socket_;
};

TEST_F(HidOnUsbTest, CarriesReportsBothWays) {
  hid_script_->to_send = {Bytes(14, 0x3C)};
  EXPECT_EQ(transfer(host_.read(HidOnUsb::kIn, 64), true).data, Bytes(14, 0x3C));
  EXPECT_EQ(transfer(host_.write(HidOnUsb::kOut, Bytes(8, 0x11)), false).status, 0);
  EXPECT_EQ(hid_script_->received, (std::vector<Bytes>{Bytes(8, 0x11)}));
}

TEST_F(HidOnUsbTest, HasTheDescriptorsAndRequestsOfItsClass) {
  const Bytes report = hid_.report_descriptor();
  EXPECT_EQ(transfer(host_.control({0x81, 6, 0, 0x22, 0, 0, 255, 0}), true).data, report);
  EXPECT_EQ(transfer(host_.control({0x21, 0x0A, 0, 0, 0, 0, 0, 0}), false).status, 0);
  EXPECT_EQ(transfer(host_.control({0xA1, 1, 1, 3, 0, 0, 8, 0}), true).status, -EPIPE)
      << "a model without feature reports";
  EXPECT_EQ(transfer(host_.control({0xA1, 1, 1, 9, 0, 0, 8, 0}), true).status, -EPIPE);
}

}  // namespace
}  // namespace thimble::sim
