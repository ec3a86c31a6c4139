#include "sim/model/cam/cam_usb_model.hpp"

#include <gtest/gtest.h>

#include <random>

#include "drivers/cambus/usb_frame.hpp"

// The board's side of docs/cambus.md, section 7: golden bytes, then what hosts may do wrong.
namespace thimble::sim::cam {
namespace {

namespace usb = cambus::usb;
namespace page = cambus::page;
using cambus::UsbHead;
using plugin::UsbHandshake;
using usb::Kind;
using usb::Status;
using Bytes = std::vector<std::uint8_t>;

class CamUsbModelTest : public testing::Test {
 protected:
  CamUsbModelTest() { model_.advance({}); }

  UsbHandshake send(const Bytes& transfer) {
    for (std::size_t at = 0; at < transfer.size(); at += 64) {
      const auto packet =
          std::span(transfer).subspan(at).first(std::min<std::size_t>(64, transfer.size() - at));
      const UsbHandshake said = model_.out_packet(usb::kRequests, packet);
      if (said != UsbHandshake::Ack) return said;
    }
    return UsbHandshake::Ack;
  }
  void say(Kind kind, std::uint16_t words, std::uint32_t offset, const Bytes& payload = {}) {
    send(cambus::usb_request({kind, {}, ++number_, words, offset}, payload));
  }
  void begin() {
    say(Kind::Begin, 0, 0);
    expect({Kind::Begin, Status::Done, number_, 0, 0});
  }
  // One transfer; nothing where the board says Nak.
  std::optional<Bytes> hear() {
    Bytes transfer;
    std::array<std::uint8_t, 64> room{};
    while (true) {
      const auto answer = model_.in_packet(usb::kReplies, room);
      if (answer.handshake == UsbHandshake::Nak) return std::nullopt;
      transfer.insert(transfer.end(), room.begin(),
                      room.begin() + static_cast<std::ptrdiff_t>(answer.size));
      if (answer.size < 64) return transfer;
    }
  }
  Bytes expect(const UsbHead& head) {
    const auto transfer = hear();
    EXPECT_TRUE(transfer);
    if (!transfer) return {};
    const auto reply = cambus::parse_usb_reply(*transfer);
    EXPECT_TRUE(reply);
    if (!reply) return {};
    EXPECT_EQ(reply->head, head);
    return {reply->payload.begin(), reply->payload.end()};
  }

  CamUsbModel model_{{.shape = {{1, 1, 1}, 6}, .window_bytes = 0x20000}};
  std::uint16_t number_{0};
};

TEST_F(CamUsbModelTest, GoldenFrames) {
  const std::pair<Bytes, Bytes> exchanges[] = {
      {{0x43, 0x42, 3, 0, 2, 1, 0, 0, 0, 0, 0, 0, 0x8b, 0xb4, 0x69, 0xbd},
       {0x42, 0x43, 3, 0, 2, 1, 0, 0, 0, 0, 0, 0, 0x24, 0x27, 0x42, 0xe7}},
      {{0x43, 0x42, 1, 0, 3, 1, 1, 0, 0, 0, 0, 0, 0x8d, 0xb7, 0x6a, 0xbe},
       {0x42, 0x43, 1, 0, 3, 1, 1, 0, 0, 0, 0, 0, 0x42, 0x97, 0x12, 0xcf, 0x43, 0x41, 0x4d, 0x38}},
      {{0x43, 0x42, 2,    0,    4,    1,    1,    0,    0x10, 0x10,
        0,    0,    0xb6, 0x7d, 0x18, 0xd0, 0x78, 0x56, 0x34, 0x12},
       {0x42, 0x43, 2, 0, 4, 1, 0, 0, 0x10, 0x10, 0, 0, 0x72, 0xb1, 0xd0, 0x82}},
      {{1, 2, 3}, {0x42, 0x43, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0xad, 0x84, 0x5c, 0xff}}};
  for (const auto& [request, reply] : exchanges) {
    EXPECT_EQ(send(request), UsbHandshake::Ack);
    EXPECT_EQ(hear(), reply);
  }
  EXPECT_EQ(model_.counters(), (CamUsbCounters{.carried_out = 2, .begins = 1, .malformed = 1}));
}

TEST_F(CamUsbModelTest, TheDriverWritesTheGoldenFrames) {
  EXPECT_EQ(cambus::usb_request({Kind::Write, {}, 0x104, 1, 0x1010}, Bytes{0x78, 0x56, 0x34, 0x12}),
            (Bytes{0x43, 0x42, 2,    0,    4,    1,    1,    0,    0x10, 0x10,
                   0,    0,    0xb6, 0x7d, 0x18, 0xd0, 0x78, 0x56, 0x34, 0x12}));
}

TEST_F(CamUsbModelTest, WhatIsWrittenIsRead) {
  begin();
  std::mt19937 random(3);
  for (const std::uint16_t words :
       std::initializer_list<std::uint16_t>{1, 11, 12, 13, 27, 28, 29, 1000, 16'384}) {
    Bytes payload(4 * std::size_t{words});
    for (auto& byte : payload) byte = static_cast<std::uint8_t>(random());
    auto write = cambus::usb_request({Kind::Write, {}, ++number_, words, 0x1000}, payload);
    ASSERT_EQ(send(write), UsbHandshake::Ack);
    // Whole packets alone do not end it.
    if (write.size() % 64 == 0) {
      EXPECT_EQ(hear(), std::nullopt);
      model_.out_packet(usb::kRequests, {});
    }
    expect({Kind::Write, Status::Done, number_, 0, 0x1000});
    say(Kind::Read, words, 0x1000);
    EXPECT_EQ(expect({Kind::Read, Status::Done, number_, words, 0x1000}), payload) << words;
  }
}

TEST_F(CamUsbModelTest, NothingIsDoneBeforeItBegins) {
  say(Kind::Write, 1, 0x1000, {1, 2, 3, 4});
  expect({Kind::Write, Status::OutOfOrder, number_, 0, 0x1000});
  begin();
  say(Kind::Read, 1, 0x1000);
  EXPECT_EQ(expect({Kind::Read, Status::Done, number_, 1, 0x1000}), Bytes(4));
}

TEST_F(CamUsbModelTest, BehindWhatIsSpoiltOrMissingNothingIsDone) {
  for (const bool is_spoilt : {false, true}) {
    begin();
    ++number_;
    auto lost = cambus::usb_request({Kind::Write, {}, number_, 1, 0x1000}, Bytes{1, 2, 3, 4});
    if (is_spoilt) {
      lost.back() ^= 1;
      send(lost);
      expect({Kind::None, Status::Malformed, 0, 0, 0});
    }
    for (int i = 0; i < 3; ++i) {
      say(Kind::Write, 1, 0x1000, {5, 6, 7, 8});
      expect({Kind::Write, Status::OutOfOrder, number_, 0, 0x1000});
    }
    begin();
    say(Kind::Read, 1, 0x1000);
    EXPECT_EQ(expect({Kind::Read, Status::Done, number_, 1, 0x1000}), Bytes(4));
  }
}

TEST_F(CamUsbModelTest, OutOfRangeAndNotAlignedAreAnsweredAndTheStreamGoesOn) {
  begin();
  const std::uint32_t end = 0x21000;
  for (const auto& [offset, words, status] :
       {std::tuple<std::uint32_t, std::uint16_t, Status>{end - 4, 2, Status::OutOfRange},
        {end, 1, Status::OutOfRange},
        {0xfffffffc, 1, Status::OutOfRange},
        {0xfffffffc, 16'384, Status::OutOfRange},
        {2, 1, Status::NotAligned}}) {
    say(Kind::Read, words, offset);
    expect({Kind::Read, status, number_, 0, offset});
  }
  say(Kind::Write, 1, end, {1, 2, 3, 4});
  expect({Kind::Write, Status::OutOfRange, number_, 0, end});
  say(Kind::Read, 1, end - 4);
  expect({Kind::Read, Status::Done, number_, 1, end - 4});
  EXPECT_EQ(model_.counters().refused, 6U);
}

TEST_F(CamUsbModelTest, WhatHasNoMeaningIsMalformed) {
  const Bytes four{1, 2, 3, 4};
  const std::pair<UsbHead, Bytes> wrong[] = {
      {{Kind::None, {}, 1, 0, 0}, {}},      {{static_cast<Kind>(4), {}, 1, 1, 0}, {}},
      {{Kind::Read, {}, 1, 0, 0}, {}},      {{Kind::Read, {}, 1, 1, 0}, four},
      {{Kind::Read, {}, 1, 16'385, 0}, {}}, {{Kind::Write, {}, 1, 0, 0}, {}},
      {{Kind::Write, {}, 1, 2, 0}, four},   {{Kind::Write, {}, 1, 1, 0}, {1, 2, 3}},
      {{Kind::Begin, {}, 1, 1, 0}, {}},     {{Kind::Begin, {}, 1, 0, 4}, {}},
      {{Kind::Begin, {}, 1, 0, 0}, four},   {{Kind::Write, {}, 1, 16'385, 0}, Bytes(4 * 16'385)}};
  for (const auto& [head, payload] : wrong) {
    auto transfer = cambus::usb_request(head, payload);
    ASSERT_EQ(send(transfer), UsbHandshake::Ack);
    if (transfer.size() % 64 == 0) model_.out_packet(usb::kRequests, {});
    expect({Kind::None, Status::Malformed, 0, 0, 0});
  }
  EXPECT_EQ(model_.counters().malformed, std::size(wrong));
}

TEST_F(CamUsbModelTest, ItPutsOffWhatItHasNoRoomToAnswer) {
  begin();
  for (int i = 0; i < 8; ++i) say(Kind::Read, 1, 0);
  const auto ninth = cambus::usb_request({Kind::Read, {}, ++number_, 1, 0}, {});
  EXPECT_EQ(send(ninth), UsbHandshake::Nak);
  hear();
  EXPECT_EQ(send(ninth), UsbHandshake::Ack);
  while (hear()) {
  }
  say(Kind::Read, 16'384, 0);
  EXPECT_EQ(send(cambus::usb_request({Kind::Read, {}, 99, 1, 0}, {})), UsbHandshake::Nak);
  EXPECT_EQ(model_.counters().put_off, 2U);
}

TEST_F(CamUsbModelTest, BeginningDropsWhatWasNotFetched) {
  begin();
  for (int i = 0; i < 5; ++i) say(Kind::Read, 100, 0);
  std::array<std::uint8_t, 64> room{};
  EXPECT_EQ(model_.in_packet(usb::kReplies, room).size, 64U);
  begin();
  EXPECT_EQ(hear(), std::nullopt);
}

TEST_F(CamUsbModelTest, APowerCutIsAnotherIncarnationAndForgetsAll) {
  begin();
  say(Kind::Write, 1, 0x1000, {1, 2, 3, 4});
  model_.power_cycle();
  EXPECT_EQ(hear(), std::nullopt);
  model_.advance({});
  say(Kind::Read, 1, 0x1000);
  expect({Kind::Read, Status::OutOfOrder, number_, 0, 0x1000});
  begin();
  say(Kind::Read, 1, 0x1000);
  EXPECT_EQ(expect({Kind::Read, Status::Done, number_, 1, 0x1000}), Bytes(4));
  say(Kind::Read, 1, page::kIncarnation);
  EXPECT_EQ(expect({Kind::Read, Status::Done, number_, 1, page::kIncarnation}),
            (Bytes{2, 0, 0, 0}));
}

// Whatever packets come, it answers, never more than it may, and a begin brings it back.
TEST_F(CamUsbModelTest, NothingThatAHostSaysBreaksIt) {
  std::mt19937 random(11);
  for (int i = 0; i < 3000; ++i) {
    Bytes transfer = cambus::usb_request({static_cast<Kind>(random() % 5),
                                          {},
                                          number_++,
                                          static_cast<std::uint16_t>(random() % 40),
                                          static_cast<std::uint32_t>(random() % 0x22000)},
                                         Bytes(random() % 3 == 0 ? 4 * (random() % 40) : 0));
    if (random() % 3 == 0)
      transfer[random() % transfer.size()] ^= static_cast<std::uint8_t>(1 + random() % 255);
    if (random() % 4 == 0) transfer.resize(random() % transfer.size());
    send(transfer);
    if (random() % 2 == 0) hear();
  }
  while (hear()) {
  }
  model_.out_packet(usb::kRequests, {});
  while (hear()) {
  }
  begin();
  say(Kind::Read, 1, 0);
  EXPECT_EQ(expect({Kind::Read, Status::Done, number_, 1, 0}).front(), 'C');
}

TEST_F(CamUsbModelTest, ItsPanelSaysWhatItsMachineHasCounted) {
  const auto reading = [&](const std::string& name) {
    for (const auto& said : model_.panel()->readings()) {
      if (said.name == name) return said.value;
    }
    return -1.0;
  };
  EXPECT_EQ(reading("unmodelled"), 0);
  begin();
  Bytes display_lengths(24);  // registers, which of them are meant, and the doorbell
  display_lengths[16] = 1U << 2;
  display_lengths[20] = 1;
  say(Kind::Write, 6, page::kWritten, display_lengths);
  EXPECT_TRUE(hear());
  EXPECT_EQ(reading("unmodelled"), 0);
  EXPECT_EQ(reading("doorbells"), 1);
  EXPECT_EQ(reading("scans"), 0);
  EXPECT_FALSE(model_.panel()->press(0, true));
}

}  // namespace
}  // namespace thimble::sim::cam
