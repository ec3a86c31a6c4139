#include "sim/export/acm_on_usb.hpp"

#include <gtest/gtest.h>

#include <cerrno>
#include <memory>
#include <random>
#include <string>

#include "hal/bus/usb_descriptor.hpp"
#include "sim/export/usbip_session.hpp"
#include "sim/model/arm/text_arm_model.hpp"
#include "tests/support/scripted_serial_model.hpp"
#include "tests/unit/export/export_bench.hpp"
#include "tests/unit/export/usbip_host.hpp"

namespace thimble::sim {
namespace {

using Bytes = UsbipHost::Bytes;
using plugin::UsbHandshake;

constexpr std::uint32_t kReadBytes = 128;  // two packets, as Linux's cdc_acm asks for

// A device, and a host that has attached it by USB/IP.
struct AttachedAcm {
  explicit AttachedAcm(plugin::SimSerialModel& serial) : device(serial) {
    session.set_available(true);
    EXPECT_TRUE(session.take(UsbipHost::import()));
    session.outbox().clear();
  }
  void say(const Bytes& bytes) { ASSERT_TRUE(session.take(bytes)); }
  void serve(int rounds = 1) {
    for (int i = 0; i < rounds; ++i) {
      bench.clock.run_for(std::chrono::microseconds(125));
      device.advance(bench.clock.now());
      session.serve(bench.clock.now());
    }
  }
  UsbipHost::Reply transfer(const Bytes& message, bool has_data, int rounds = 8) {
    say(message);
    serve(rounds);
    return UsbipHost::take_reply(session.outbox(), has_data).value_or(UsbipHost::Reply{});
  }

  ExportBench bench;
  UsbipHost host;
  AcmOnUsb device;
  UsbPersona persona{device.persona(device.describe())};
  UsbipSession session{device, persona, 8, bench.surroundings()};
};

class AcmOnUsbTest : public ::testing::Test {
 protected:
  std::shared_ptr<test::SerialModelScript> script_ = std::make_shared<test::SerialModelScript>();
  test::ScriptedSerialModel serial_{script_};
  AttachedAcm bus_{serial_};
  AcmOnUsb& sut_{bus_.device};
};

// What cdc_acm of Linux 6.1 reads of it: the union names both interfaces, that of the data has
// class 10 and two endpoints, that of the union one; the capabilities have the three requests.
TEST_F(AcmOnUsbTest, HasTheDescriptorsThatADriverOfItsClassLooksFor) {
  const Bytes device = usb_descriptor(bus_.persona, 1, 0);
  EXPECT_EQ(device[4], 2) << "communications device";
  const Bytes bytes = usb_descriptor(bus_.persona, 2, 0);
  ASSERT_EQ(bytes.size(), bytes[2] + 256U * bytes[3]);
  EXPECT_EQ(bytes[4], 2) << "interfaces";
  std::vector<Bytes> interfaces;
  std::vector<Bytes> functional;
  std::vector<int> endpoints;
  for (std::size_t at = 0; at < bytes.size(); at += bytes[at]) {
    ASSERT_GE(bytes[at], 2);
    ASSERT_LE(at + bytes[at], bytes.size());
    const Bytes one(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                    bytes.begin() + static_cast<std::ptrdiff_t>(at + bytes[at]));
    if (one[1] == 4) interfaces.push_back(one);
    if (one[1] == 4) endpoints.push_back(0);
    if (one[1] == 0x24) {
      functional.push_back(one);
      EXPECT_EQ(interfaces.size(), 1U) << "they belong to the interface before them";
    }
    if (one[1] == 5) ++endpoints.back();
  }
  ASSERT_EQ(interfaces.size(), 2U);
  EXPECT_EQ(Bytes(interfaces[0].begin() + 2, interfaces[0].end()), (Bytes{0, 0, 1, 2, 2, 1, 0}));
  EXPECT_EQ(Bytes(interfaces[1].begin() + 2, interfaces[1].end()), (Bytes{1, 0, 2, 10, 0, 0, 0}));
  EXPECT_EQ(endpoints, (std::vector<int>{1, 2}));
  EXPECT_EQ(functional,
            (std::vector<Bytes>{
                {5, 0x24, 0, 0x20, 1}, {5, 0x24, 1, 0, 1}, {4, 0x24, 2, 2}, {5, 0x24, 6, 0, 1}}));
}

TEST_F(AcmOnUsbTest, HasItsDescriptorsReadBackByOurOwnBus) {
  Bytes all = usb_descriptor(bus_.persona, 1, 0);
  const Bytes configuration = usb_descriptor(bus_.persona, 2, 0);
  all.insert(all.end(), configuration.begin(), configuration.end());
  EXPECT_EQ(bus::parse_usb_descriptors(all, 1), sut_.describe().endpoints);
  EXPECT_EQ(sut_.describe().vendor_id, 0x16C0);
}

TEST_F(AcmOnUsbTest, KeepsAnyLineCodingAndTellsItAgain) {
  std::mt19937 random(7);
  for (int i = 0; i < 300; ++i) {
    Bytes coding(7);
    for (std::uint8_t& byte : coding) byte = static_cast<std::uint8_t>(random());
    EXPECT_EQ(
        bus_.transfer(bus_.host.control({0x21, 0x20, 0, 0, 0, 0, 7, 0}, coding), false).status, 0);
    EXPECT_EQ(bus_.transfer(bus_.host.control({0xA1, 0x21, 0, 0, 0, 0, 7, 0}), true).data, coding);
  }
  sut_.power_cycle();
  EXPECT_EQ(bus_.transfer(bus_.host.control({0xA1, 0x21, 0, 0, 0, 0, 7, 0}), true).data,
            (Bytes{0x00, 0xC2, 0x01, 0x00, 0, 0, 8}));
  EXPECT_EQ(script_->power_cycles, 1);
}

TEST_F(AcmOnUsbTest, IsToldWhoHasThePortOpen) {
  for (const std::uint8_t lines : Bytes{3, 1, 0}) {
    const Bytes request = bus_.host.control({0x21, 0x22, lines, 0, 0, 0, 0, 0});
    EXPECT_EQ(bus_.transfer(request, false).status, 0);
    EXPECT_EQ(sut_.control_lines(), lines);
  }
}

// Oracle: the three requests as PSTN 1.2 writes them, to interface 0; all others stall.
TEST_F(AcmOnUsbTest, AnswersEveryRequestThereCanBe) {
  std::mt19937 random(3);
  std::array<std::uint8_t, 64> room{};
  for (unsigned word = 0; word < 0x10000; ++word) {
    bus::UsbControlRequest request;
    request.request_type = static_cast<std::uint8_t>(word >> 8U);
    request.request = static_cast<std::uint8_t>(word);
    request.value = static_cast<std::uint16_t>(random());
    request.index = static_cast<std::uint16_t>(random() % 2);
    request.length = static_cast<std::uint16_t>(random() % 9);
    const bool is_out = request.request_type == 0x21;
    const bool is_known =
        request.index == 0 && ((is_out && request.request == 0x20 && request.length == 7) ||
                               (is_out && request.request == 0x22) || word == 0xA121);
    const auto answer = sut_.control(request, std::span(room).first(request.length));
    EXPECT_EQ(answer.handshake, is_known ? UsbHandshake::Ack : UsbHandshake::Stall) << word;
    EXPECT_LE(answer.size, request.length);
  }
}

TEST_F(AcmOnUsbTest, RefusesEndpointsThatItDoesNotHaveAndIsSilentOnTheInterruptPipe) {
  EXPECT_EQ(bus_.transfer(bus_.host.read(0x83, 64), true).status, -EPIPE);
  EXPECT_EQ(bus_.transfer(bus_.host.write(0x01, {1}), false).status, -EPIPE);
  bus_.say(bus_.host.read(AcmOnUsb::kNotifications, 16));
  bus_.serve(1000);
  EXPECT_EQ(bus_.session.waiting(), 1U);
  std::array<std::uint8_t, 64> room{};
  EXPECT_EQ(sut_.in_packet(0x85, room).handshake, UsbHandshake::Stall);
  EXPECT_EQ(sut_.out_packet(0x05, room), UsbHandshake::Stall);
}

TEST_F(AcmOnUsbTest, EndsWhatFillsAPacketWithAnEmptyOne) {
  script_->to_send.assign(64, 'x');
  const auto reply = bus_.transfer(bus_.host.read(AcmOnUsb::kIn, kReadBytes), true);
  EXPECT_EQ(reply.data, Bytes(64, 'x')) << "the host does not wait for more";
  bus_.say(bus_.host.read(AcmOnUsb::kIn, kReadBytes));
  bus_.serve(100);
  EXPECT_EQ(bus_.session.waiting(), 1U) << "and is told so once";
}

TEST_F(AcmOnUsbTest, CarriesNoMoreThanAFullSpeedBusHasRoomFor) {
  script_->to_send.assign(10'000, 'x');
  for (int i = 0; i < 16; ++i) bus_.say(bus_.host.read(AcmOnUsb::kIn, kReadBytes));
  bus_.serve(8);
  const std::size_t carried = 10'000 - script_->to_send.size();
  EXPECT_EQ(carried, 1024U) << "two packets in each eighth of a frame";
}

// What the device has no room for waits, in order, and keeps the host waiting; not for ever after
// its power was cut.
TEST_F(AcmOnUsbTest, KeepsAPacketThatTheDeviceHasNoRoomFor) {
  script_->is_deaf = true;
  const Bytes first(64, 'a');
  const Bytes second(10, 'b');
  EXPECT_EQ(bus_.transfer(bus_.host.write(AcmOnUsb::kOut, first), false).actual, 64U);
  bus_.say(bus_.host.write(AcmOnUsb::kOut, second));
  bus_.serve(100);
  EXPECT_EQ(bus_.session.waiting(), 1U);
  script_->is_deaf = false;
  bus_.serve(2);
  EXPECT_EQ(bus_.session.waiting(), 0U);
  Bytes both = first;
  both.insert(both.end(), second.begin(), second.end());
  EXPECT_EQ(script_->received, both);

  script_->is_deaf = true;
  EXPECT_EQ(sut_.out_packet(AcmOnUsb::kOut, second), UsbHandshake::Ack);
  sut_.power_cycle();
  script_->is_deaf = false;
  sut_.advance(bus_.bench.clock.now());
  EXPECT_EQ(script_->received, both);
}

// Takes and gives as much as dice say.
class FitfulSerialModel final : public plugin::SimSerialModel {
 public:
  [[nodiscard]] bus::BusDeviceInfo describe() const override { return {}; }
  [[nodiscard]] std::uint32_t bit_per_s() const noexcept override { return 0; }
  void advance(MonotonicTime /*t*/) noexcept override {}
  std::size_t take(std::span<const std::uint8_t> bytes) noexcept override {
    const std::size_t size = std::min<std::size_t>(random() % 80, bytes.size());
    taken.insert(taken.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    return size;
  }
  std::size_t give(std::span<std::uint8_t> out) noexcept override {
    const std::size_t size =
        random() % 3 == 0 ? out.size() : std::min<std::size_t>(random() % 80, out.size());
    for (std::size_t i = 0; i < size; ++i) {
      out[i] = static_cast<std::uint8_t>(random());
      given.push_back(out[i]);
    }
    return size;
  }
  void power_cycle() noexcept override {}
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override { return nullptr; }

  std::mt19937 random{11};
  Bytes taken;
  Bytes given;
};

TEST(AcmOnUsbStreams, LoseNoByteAndKeepTheirOrder) {
  FitfulSerialModel serial;
  AttachedAcm bus(serial);
  std::mt19937 random(5);
  Bytes written;
  Bytes read;
  std::size_t ended = 0;
  std::vector<bool> is_read;  // of each submit, by its number
  for (int round = 0; round < 5000; ++round) {
    if (bus.session.waiting() < 20) {
      const bool is_in = random() % 2 == 0;
      Bytes data(1 + random() % 200);
      for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>(random());
      if (!is_in) written.insert(written.end(), data.begin(), data.end());
      bus.say(is_in ? bus.host.read(AcmOnUsb::kIn, kReadBytes)
                    : bus.host.write(AcmOnUsb::kOut, data));
      is_read.push_back(is_in);
    }
    bus.serve();
    while (bus.session.outbox().size() >= 48) {
      const std::uint32_t number = UsbipHost::get(bus.session.outbox(), 4);
      const auto reply = UsbipHost::take_reply(bus.session.outbox(), is_read.at(number - 1));
      ASSERT_TRUE(reply);
      ASSERT_EQ(reply->status, 0);
      read.insert(read.end(), reply->data.begin(), reply->data.end());
      ++ended;
    }
  }
  EXPECT_GT(ended, 1000U);
  // What is under way may be missing at the end, and nowhere else.
  ASSERT_GE(serial.given.size(), read.size());
  EXPECT_LE(serial.given.size() - read.size(), 64U);
  EXPECT_EQ(read, Bytes(serial.given.begin(),
                        serial.given.begin() + static_cast<std::ptrdiff_t>(read.size())));
  ASSERT_GE(written.size(), serial.taken.size());
  EXPECT_LE(written.size() - serial.taken.size(), 20U * 200U);
  EXPECT_EQ(
      serial.taken,
      Bytes(written.begin(), written.begin() + static_cast<std::ptrdiff_t>(serial.taken.size())));
}

class AcmArmTest : public ::testing::Test {
 protected:
  AcmArmTest() {
    register_text_arm_models(models_);
    model_ = *models_.find("phantom-vintage-serial")->create_serial({});
    bus_ = std::make_unique<AttachedAcm>(*model_);
    bus_->serve(8 * 600);  // it boots
  }
  UsbipHost::Reply ask(const std::string& message) {
    EXPECT_EQ(
        bus_->transfer(bus_->host.write(AcmOnUsb::kOut, {message.begin(), message.end()}), false)
            .status,
        0);
    return bus_->transfer(bus_->host.read(AcmOnUsb::kIn, kReadBytes), true);
  }
  static constexpr const char* kNoCurrent = "[0,0,0]\n\n\n\n\n\n\n\n\n";

  plugin::SimModelRegistry models_;
  std::unique_ptr<plugin::SimSerialModel> model_;
  std::unique_ptr<AttachedAcm> bus_;
};

TEST_F(AcmArmTest, AnswersEachMessageWithALine) {
  for (int i = 0; i < 3; ++i) {
    const Bytes data = ask(kNoCurrent).data;
    const std::string line(data.begin(), data.end());
    EXPECT_TRUE(line.starts_with("[2,")) << line;
    EXPECT_TRUE(line.ends_with(",0]\n")) << line;
  }
  EXPECT_NE(bus_->bench.lines().find(R"("out":"5b302c302c305d0a)"), std::string::npos);
  EXPECT_NE(bus_->bench.lines().find(R"("in":"5b32)"), std::string::npos);
}

TEST_F(AcmArmTest, MisbehavesOnDemandLikeAnyOther) {
  const Bytes sound = ask(kNoCurrent).data;
  bus_->bench.misbehaviour.corrupt(1);
  EXPECT_NE(ask(kNoCurrent).data, sound);
  bus_->bench.misbehaviour.babble(1);
  EXPECT_GT(ask(kNoCurrent).data.size(), sound.size());
  bus_->bench.misbehaviour.shorten(1);
  EXPECT_EQ(ask(kNoCurrent).data.size(), sound.size() / 2);
  bus_->bench.misbehaviour.stall_until(bus_->bench.clock.now() + std::chrono::seconds(1));
  EXPECT_EQ(bus_->transfer(bus_->host.read(AcmOnUsb::kIn, kReadBytes), true).status, -EPIPE);
}

}  // namespace
}  // namespace thimble::sim
