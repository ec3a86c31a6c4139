#include "sim/bus/sim_serial.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <numeric>
#include <vector>

#include "sim/bus/sim_enumerator.hpp"
#include "sim/time/virtual_clock.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/scripted_serial_model.hpp"
#include "tests/support/scripted_usb_model.hpp"

namespace thimble::sim {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using Bytes = std::vector<std::uint8_t>;

struct SimSerialTest : testing::Test {
  const bus::DeviceAddress address{"sim:a"};
  VirtualClock clock;
  SimEnumerator buses{clock};
  std::shared_ptr<test::SerialModelScript> script = std::make_shared<test::SerialModelScript>();

  void plug(std::uint32_t bit_per_s = 0) {
    script->bit_per_s = bit_per_s;
    auto model = std::make_unique<test::ScriptedSerialModel>(script);
    EXPECT_TRUE(buses.plug(address, std::move(model)).has_value());
  }
  std::unique_ptr<bus::SerialPort> open(std::uint32_t bit_per_s = 115'200) {
    return buses.open_serial(address, {bit_per_s}).value();
  }
  // Of every chunk that waits: its time in µs and its size.
  static std::vector<std::pair<std::int64_t, std::size_t>> chunks(bus::SerialPort& sut) {
    std::vector<std::pair<std::int64_t, std::size_t>> found;
    bus::SerialChunk chunk;
    while (sut.read(chunk) == IoStatus::Ok) {
      found.emplace_back(chunk.arrived_at.since_epoch / microseconds(1), chunk.size);
    }
    return found;
  }
};

TEST_F(SimSerialTest, AcmCarriesPacketsOf64BytesInTheRoundsOfTheBus) {
  plug();
  const auto sut = open();
  script->to_send.assign(200, 7);
  clock.run_for(milliseconds(1));
  using Found = std::vector<std::pair<std::int64_t, std::size_t>>;
  EXPECT_EQ(chunks(*sut), (Found{{125, 64}, {125, 64}, {250, 64}, {250, 8}}));
}

TEST_F(SimSerialTest, WhatGoesOutLeavesLessOfTheRoundForWhatComesIn) {
  plug();
  const auto sut = open();
  script->to_send.assign(128, 7);
  ASSERT_EQ(sut->submit(Bytes(64, 1)), IoStatus::Ok);
  clock.run_for(microseconds(125));
  EXPECT_EQ(script->received.size(), 64U);
  EXPECT_EQ(script->to_send.size(), 64U);
}

TEST_F(SimSerialTest, ALongMessageIsCarriedAPacketARoundAndNeverMixedWithTheNext) {
  plug();
  const auto sut = open();
  ASSERT_EQ(sut->submit(Bytes(130, 1)), IoStatus::Ok);
  clock.run_for(microseconds(125));
  EXPECT_EQ(sut->submit(Bytes(10, 2)), IoStatus::Backlogged);
  EXPECT_EQ(sut->counters().messages_out, 0U);
  clock.run_for(microseconds(375));
  Bytes expected(130, 1);
  expected.insert(expected.end(), 10, 2);
  EXPECT_EQ(script->received, expected);
  EXPECT_EQ(script->received_at.front(), MonotonicTime{microseconds(125)});
  EXPECT_EQ(script->received_at[129], MonotonicTime{microseconds(375)});
  EXPECT_EQ(script->received_at[130], MonotonicTime{microseconds(500)});
}

// 10 bits a byte: over any time a line carries what its rate says, to the byte.
TEST_F(SimSerialTest, ALineCarriesItsRateToTheByte) {
  for (const std::uint32_t rate : {38'400U, 115'200U, 921'600U, 3'000'000U}) {
    VirtualClock own_clock;
    SimEnumerator own_buses{own_clock};
    auto own = std::make_shared<test::SerialModelScript>();
    own->bit_per_s = rate;
    own->to_send.assign(1'000'000, 1);
    ASSERT_TRUE(own_buses.plug(address, std::make_unique<test::ScriptedSerialModel>(own)));
    const auto sut = own_buses.open_serial(address, {rate}).value();
    std::size_t bytes = 0;
    for (int ms = 1; ms <= 1000; ++ms) {
      own_clock.run_for(milliseconds(1));
      for (const auto& [at, size] : chunks(*sut)) bytes += size;
      const auto carried = static_cast<std::size_t>(rate) * static_cast<std::size_t>(ms) / 10'000;
      ASSERT_LE(bytes, carried) << rate << " bit/s, " << ms << " ms";
      ASSERT_GE(bytes + 1, carried) << rate << " bit/s, " << ms << " ms";
    }
  }
}

TEST_F(SimSerialTest, AnIdleLineSavesNothingUp) {
  plug(38'400);
  const auto sut = open(38'400);
  clock.run_for(milliseconds(500));
  script->to_send.assign(1000, 1);
  clock.run_for(milliseconds(10));
  EXPECT_LE(1000 - script->to_send.size(), 38'400U / 1000 + 2);
}

TEST_F(SimSerialTest, ALineThatIsSetToAnotherRateCarriesNothing) {
  plug(115'200);
  script->to_send.assign(10, 1);
  {
    const auto sut = open(921'600);
    EXPECT_EQ(sut->submit(Bytes{1}), IoStatus::Ok);
    clock.run_for(milliseconds(50));
    EXPECT_EQ(sut->counters(), bus::SerialCounters{});
    EXPECT_TRUE(script->received.empty());
  }
  const auto sut = open(115'200);
  clock.run_for(milliseconds(50));
  EXPECT_EQ(sut->counters().bytes_in, 10U);
}

TEST_F(SimSerialTest, OnlyOneMayHoldAPortAndOnlyAsWhatItIs) {
  plug();
  auto sut = open();
  const auto second = buses.open_serial(address, {});
  ASSERT_FALSE(second.has_value());
  EXPECT_EQ(second.error().code, Errc::Busy);
  sut.reset();
  EXPECT_FALSE(buses.open_hid(address).has_value());
  EXPECT_FALSE(buses.open_serial({"sim:nowhere"}, {}).has_value());
  EXPECT_EQ(buses.list().at(0).kind, bus::BusKind::Serial);
  auto usb = std::make_shared<test::UsbModelScript>();
  ASSERT_TRUE(buses.plug({"sim:u"}, std::make_unique<test::ScriptedUsbModel>(usb)));
  EXPECT_FALSE(buses.open_serial({"sim:u"}, {}).has_value());
  EXPECT_TRUE(buses.open_serial(address, {}).has_value());
}

TEST_F(SimSerialTest, AfterAReplugTheOldHandleStaysDeadAndANewOneWorks) {
  plug();
  const auto old = open();
  ASSERT_TRUE(buses.unplug(address));
  clock.run_for(milliseconds(2));
  EXPECT_FALSE(buses.open_serial(address, {}).has_value());
  ASSERT_TRUE(buses.replug(address));
  const auto sut = open();
  script->to_send = {1, 2};
  clock.run_for(milliseconds(2));
  bus::SerialChunk chunk;
  EXPECT_EQ(old->read(chunk), IoStatus::Disconnected);
  EXPECT_EQ(sut->read(chunk), IoStatus::Ok);
  EXPECT_EQ(script->power_cycles, 2) << "both ends of the time without power";
}

TEST_F(SimSerialTest, AMessageThatWasCutByClosingIsNotFinishedByTheNextOpener) {
  plug();
  {
    const auto first = open();
    ASSERT_EQ(first->submit(Bytes(130, 1)), IoStatus::Ok);
    clock.run_for(microseconds(125));
  }
  const auto sut = open();
  ASSERT_EQ(sut->submit(Bytes(10, 2)), IoStatus::Ok);
  clock.run_for(milliseconds(1));
  Bytes expected(64, 1);
  expected.insert(expected.end(), 10, 2);
  EXPECT_EQ(script->received, expected);
}

TEST_F(SimSerialTest, TrafficAllocatesNothing) {
  plug();
  const auto sut = open();
  script->is_deaf = true;  // the script's own vectors would grow
  const Bytes message(16, 1);
  clock.run_for(milliseconds(10));
  bus::SerialChunk chunk;
  const std::uint64_t before = test::allocation_count();
  for (int i = 0; i < 100; ++i) {
    static_cast<void>(sut->submit(message));
    clock.run_for(milliseconds(1));
    static_cast<void>(sut->read(chunk));
  }
  EXPECT_EQ(test::allocation_count(), before);
}

}  // namespace
}  // namespace thimble::sim
