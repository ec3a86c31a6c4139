#include "drivers/cambus/cambus_registers.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <set>
#include <string>

#include "drivers/cambus/register_words.hpp"

namespace thimble::cambus {
namespace {

// Written from the manual's section titles, chapter 6; 0 for the two ports.
constexpr std::array<int, kRegisterCount> kWidths{3,  6,  30, 5, 6,  6,   6,  6,  6,  1,
                                                  25, 16, 5,  0, 24, 120, 0,  35, 24, 38,
                                                  16, 10, 18, 1, 1,  10,  10, 3,  16};

TEST(CambusRegisters, AreAsWideAsTheManualSaysAndInItsOrder) {
  for (std::size_t i = 0; i < kRegisterCount; ++i) {
    EXPECT_EQ(kRegisters[i].bits, kWidths[i]) << i;
    EXPECT_EQ(static_cast<std::size_t>(kRegisters[i].number), i);
  }
}

TEST(CambusRegisters, FieldsFillEachRegisterWithoutGapsAndHaveNamesOfTheirOwn) {
  std::set<std::string> names;
  for (const RegisterFacts& facts : kRegisters) {
    EXPECT_TRUE(names.insert(std::string(facts.name)).second) << facts.name;
    std::set<std::string> fields;
    int next = 0;
    for (const Field& of : facts.fields) {
      EXPECT_EQ(of.first_bit, next) << facts.name << " " << of.name;
      EXPECT_EQ(of.of, facts.number);
      EXPECT_TRUE(means_something(of.codes, of.initial));
      EXPECT_TRUE(fields.insert(std::string(of.name)).second) << of.name;
      next += of.bits;
    }
    EXPECT_EQ(next, facts.bits) << facts.name;
  }
}

// Those that may be touched during a scan: what the control software defines without an asterisk.
TEST(CambusRegisters, WhatHasNothingToDoWithAScanDoesNotWait) {
  std::set<std::string> free;
  for (const RegisterFacts& facts : kRegisters) {
    if (!facts.waits) free.insert(std::string(facts.name));
  }
  EXPECT_EQ(free, (std::set<std::string>{"select", "show-scan", "event", "lut-index", "lut-perm",
                                         "lut-io", "multi", "module-id", "group-id", "int-enable",
                                         "int-flags", "verify"}));
}

TEST(CambusRegisters, CodesThatMeanSomethingAreTheManuals) {
  for (std::uint32_t code = 0; code < 32; ++code) {
    const bool is_constant = code == 30 || code == 31;
    EXPECT_EQ(means_something(Codes::AddressBit, code), code < 24) << code;
    EXPECT_EQ(means_something(Codes::AddressBitOr01, code), code < 24 || is_constant) << code;
    EXPECT_EQ(means_something(Codes::TableIndexOr01, code), code < 16 || is_constant) << code;
    EXPECT_TRUE(means_something(Codes::Any, code));
  }
}

TEST(RegisterWords, AFieldOfSomeLayersLeavesEverythingElseAlone) {
  std::mt19937 random(1);
  for (const RegisterFacts& facts : kRegisters) {
    if (facts.bits == 0) continue;
    RegisterWords sut(facts.number);
    std::vector<std::array<std::uint32_t, kLayers>> expected(facts.fields.size());
    for (int i = 0; i < 200; ++i) {
      const std::size_t which = random() % facts.fields.size();
      const Field& of = facts.fields[which];
      const auto value = static_cast<std::uint32_t>(random());
      const auto layers = static_cast<LayerMask>(random());
      sut.set(of, value, layers);
      for (std::size_t layer = 0; layer < kLayers; ++layer) {
        const bool is_meant = ((layers >> layer) & 1U) != 0;
        if (is_meant) expected[which][layer] = value & ((1U << of.bits) - 1U);
      }
    }
    for (std::size_t which = 0; which < facts.fields.size(); ++which) {
      for (int layer = 0; layer < kLayers; ++layer) {
        ASSERT_EQ(sut.get(facts.fields[which], layer),
                  expected[which][static_cast<std::size_t>(layer)])
            << facts.name;
      }
    }
  }
}

TEST(RegisterWords, WordKHasBitKOfEachLayer) {
  RegisterWords sut(Register::LutSrc);
  sut.set(field::kSource<Register::LutSrc>[1], 0b1010, 0x8001);
  const std::vector<std::uint16_t> words(sut.words().begin(), sut.words().end());
  EXPECT_EQ(words, (std::vector<std::uint16_t>{0, 0, 0, 0x8001, 0, 0x8001}));
}

TEST(RegisterWords, ANegativeAmountIsItsTwosComplement) {
  RegisterWords sut(Register::Kick);
  sut.set(field::kKickAmount, static_cast<std::uint32_t>(-1));
  EXPECT_EQ(sut.get(field::kKickAmount, 3), 0xffffffU);
  EXPECT_EQ(sut.get(field::kKick[1], 3), 0U);
}

TEST(RegisterWords, DefaultsAreThoseOfTheControlSoftware) {
  EXPECT_EQ(default_words(Register::Select).words()[0], 0xffff);
  const RegisterWords perm = default_words(Register::ScanPerm);
  for (std::size_t bit = 0; bit < kAddressBits; ++bit) {
    EXPECT_EQ(perm.get(field::kScanPerm[bit], 5), bit);
  }
  std::uint32_t enabled = 0;
  const RegisterWords interrupts = default_words(Register::IntEnable);
  for (std::size_t bit = 0; bit < interrupts.words().size(); ++bit) {
    enabled |= interrupts.words()[bit] != 0 ? 1U << bit : 0U;
  }
  EXPECT_EQ(enabled, 0x3e4U);
  for (int layer = 0; layer < kLayers; ++layer) {
    EXPECT_EQ(default_words(Register::LutPerm).get(field::kLutPerm[0], layer),
              static_cast<std::uint32_t>(layer));
  }
  EXPECT_EQ(default_words(Register::SiteSrc).get(field::kSource<Register::SiteSrc>[1], 0), 10U);
  EXPECT_EQ(default_words(Register::Display).get(field::kSource<Register::Display>[1], 0), 0U);
  EXPECT_EQ(default_words(Register::ScanFormat).get(field::kEventLength, 9), 25U);
  EXPECT_EQ(default_words(Register::Multi).get(field::kMulti[1], 10), 4U);
}

}  // namespace
}  // namespace thimble::cambus
