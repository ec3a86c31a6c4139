#include "sim/model/cp2112/cp2112_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

namespace thimble::sim {
namespace {

using plugin::HidReportKind;
using Bytes = std::vector<std::uint8_t>;

struct Cp2112ModelTest : testing::Test {
  Cp2112Model sut;

  Bytes get(std::uint8_t number) {
    Bytes out(64, 0xEE);
    out.resize(sut.get_report(HidReportKind::Feature, number, out));
    return out;
  }
  bool set(const Bytes& bytes) { return sut.set_report(HidReportKind::Feature, bytes); }
  std::uint8_t levels() { return get(Cp2112Model::kGetGpio).at(1); }
};

TEST_F(Cp2112ModelTest, SaysWhatItIs) {
  EXPECT_EQ(get(Cp2112Model::kVersion), (Bytes{0x05, 0x0C, 2}));
  EXPECT_EQ(sut.describe().vendor_id, 0x10C4);
  EXPECT_EQ(sut.describe().product_id, 0xEA90);
  EXPECT_EQ(sut.arm_backend(), nullptr);
}

TEST_F(Cp2112ModelTest, ItsReportsHaveTheLengthsThatTheDriverAsksFor) {
  EXPECT_EQ(get(0x02).size(), 5U);
  EXPECT_EQ(get(0x03).size(), 2U);
  EXPECT_EQ(get(0x06).size(), 14U);
  EXPECT_EQ(get(0x20).size(), 2U);
}

TEST_F(Cp2112ModelTest, AllLinesAreInputsOnClosedContacts) {
  EXPECT_EQ(levels(), 0x00);
  EXPECT_EQ(get(0x02), (Bytes{0x02, 0, 0, 0, 0}));
}

TEST_F(Cp2112ModelTest, AnOpenContactIsHighAndIsCounted) {
  EXPECT_TRUE(sut.press(1, true));
  EXPECT_EQ(levels(), 0x02);
  EXPECT_TRUE(sut.press(1, true));
  EXPECT_TRUE(sut.press(1, false));
  EXPECT_EQ(levels(), 0x00);
  EXPECT_EQ(sut.changes(1), 2U);
  EXPECT_FALSE(sut.press(8, true)) << "there is none";
}

TEST_F(Cp2112ModelTest, KnowsSinceWhenTheHostKnowsOfAnInput) {
  const auto at = [](int ms) { return MonotonicTime{std::chrono::milliseconds(ms)}; };
  const auto told_s = [this] {
    const auto all = sut.readings();
    return std::find_if(all.begin(), all.end(),
                        [](const auto& one) { return one.name == "told_s"; })
        ->value;
  };
  EXPECT_TRUE(set({0x02, 0x08, 0xFF, 0, 0}));
  sut.advance(at(1));
  levels();
  EXPECT_EQ(told_s(), 0);
  EXPECT_TRUE(sut.press(1, true));
  sut.advance(at(5));
  EXPECT_EQ(told_s(), 0) << "nobody asked";
  levels();
  sut.advance(at(9));
  EXPECT_TRUE(set({0x04, 0x08, 0x08}));
  levels();
  EXPECT_DOUBLE_EQ(told_s(), 0.005) << "an output is the host's own";
}

TEST_F(Cp2112ModelTest, AnOutputThatPushesHasItsLatchAndAnInputIsNotMovedByIt) {
  EXPECT_TRUE(set({0x02, 0x08, 0xFF, 0, 0}));
  EXPECT_TRUE(set({0x04, 0x00, 0x08}));
  EXPECT_EQ(levels(), 0x00);
  EXPECT_TRUE(set({0x04, 0xFF, 0x08}));
  EXPECT_EQ(levels(), 0x08);
  EXPECT_TRUE(set({0x04, 0xFF, 0x01}));
  EXPECT_EQ(levels(), 0x08) << "line 0 is an input on a closed contact";
  sut.press(3, true);
  EXPECT_TRUE(set({0x04, 0x00, 0x08}));
  EXPECT_EQ(levels(), 0x00) << "whatever hangs on the wire";
}

TEST_F(Cp2112ModelTest, AnOpenDrainOutputOnlyPullsDown) {
  EXPECT_TRUE(set({0x02, 0x10, 0x00, 0, 0}));
  EXPECT_TRUE(set({0x04, 0xFF, 0x10}));
  EXPECT_EQ(levels(), 0x00) << "the wire is low";
  sut.press(4, true);
  EXPECT_EQ(levels(), 0x10);
  EXPECT_TRUE(set({0x04, 0x00, 0x10}));
  EXPECT_EQ(levels(), 0x00);
}

TEST_F(Cp2112ModelTest, SmbusSettingsAreKept) {
  Bytes settings = get(0x06);
  settings[3] = 0x11;
  EXPECT_TRUE(set(settings));
  EXPECT_EQ(get(0x06), settings);
}

TEST_F(Cp2112ModelTest, APowerCutForgetsAllButTheWires) {
  sut.press(0, true);
  EXPECT_TRUE(set({0x02, 0x08, 0xFF, 0, 0}));
  EXPECT_TRUE(set({0x04, 0xFF, 0x08}));
  sut.power_cycle();
  EXPECT_EQ(levels(), 0x01);
  EXPECT_EQ(get(0x02), (Bytes{0x02, 0, 0, 0, 0}));
  EXPECT_EQ(sut.changes(3), 2U);
}

TEST_F(Cp2112ModelTest, ThePanelTellsLevelsAndChanges) {
  sut.press(5, true);
  double level = 0;
  double changes = 0;
  for (const auto& [name, value] : sut.readings()) {
    if (name == "line_5") level = value;
    if (name == "changes_5") changes = value;
  }
  EXPECT_EQ(level, 1);
  EXPECT_EQ(changes, 1);
  EXPECT_EQ(sut.readings().size(), 17U) << "and told_s";
}

TEST_F(Cp2112ModelTest, WhatIsNoneOfItsReportsIsRefusedAndChangesNothing) {
  sut.press(2, true);
  EXPECT_TRUE(set({0x02, 0x08, 0xFF, 0, 0}));
  std::mt19937 dice(1);
  for (int i = 0; i < 20'000; ++i) {
    Bytes bytes(dice() % 20);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(dice() % 256);
    if (!bytes.empty() && dice() % 2 == 0) bytes[0] = static_cast<std::uint8_t>(dice() % 8);
    const std::array<std::size_t, 8> lengths{0, 0, 5, 0, 3, 0, 14, 0};
    const bool is_one = !bytes.empty() && bytes[0] < 8 && bytes.size() == lengths.at(bytes[0]);
    const Bytes before = get(0x02);
    EXPECT_EQ(set(bytes), is_one);
    EXPECT_TRUE(is_one || get(0x02) == before);
    EXPECT_FALSE(sut.set_report(HidReportKind::Output, bytes));
    EXPECT_EQ(sut.get_report(HidReportKind::Input, 3, bytes), 0U);
    Bytes room(dice() % 20);
    EXPECT_LE(sut.get_report(HidReportKind::Feature, static_cast<std::uint8_t>(dice() % 64), room),
              room.size());
  }
}

}  // namespace
}  // namespace thimble::sim
