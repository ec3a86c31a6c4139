#include "daemon/link/network_bytes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace thimble::link {
namespace {

using Octets = std::vector<unsigned>;

template <class... Values>
Octets written(const Values&... values) {
  std::array<std::byte, 64> room{};
  ByteWriter sut(room);
  sut.values(values...);
  EXPECT_TRUE(sut.is_good());
  Octets out;
  for (std::size_t i = 0; i < sut.size(); ++i) out.push_back(std::to_integer<unsigned>(room[i]));
  return out;
}

TEST(NetworkBytes, AreInNetworkOrderOneValueBehindTheOther) {
  EXPECT_EQ(written(std::uint8_t{1}, std::uint16_t{0x0203}, std::uint32_t{0x04050607}),
            (Octets{1, 2, 3, 4, 5, 6, 7}));
  EXPECT_EQ(written(std::int32_t{-2}), (Octets{255, 255, 255, 254}));
  EXPECT_EQ(written(std::array<std::int16_t, 2>{1, -1}, std::array<std::int8_t, 3>{-1, 0, 1}),
            (Octets{0, 1, 255, 255, 255, 0, 1}));
  EXPECT_EQ(written(1.0), (Octets{0x3F, 0xF0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(written(MonotonicTime{Duration(258)}), (Octets{0, 0, 0, 0, 0, 0, 1, 2}));
  EXPECT_EQ(written(Force3{1, 0, 0}).size(), 24U);
}

TEST(NetworkBytes, AreReadAsTheyWereWritten) {
  const std::array<std::uint32_t, 3> cells{1, 2, 0xFFFFFFFF};
  const Position3 place{0.1, -0.2, 1e-300};
  std::array<std::byte, 64> room{};
  ByteWriter writer(room);
  writer.values(cells, place, std::int32_t{-7});
  ByteReader sut{std::span(room).first(writer.size())};
  std::array<std::uint32_t, 3> cells_read{};
  Position3 place_read{};
  std::int32_t number = 0;
  sut.values(cells_read, place_read, number);
  EXPECT_TRUE(sut.is_good());
  EXPECT_EQ(sut.left(), 0U);
  EXPECT_EQ(cells_read, cells);
  EXPECT_EQ(place_read, place);
  EXPECT_EQ(number, -7);
}

TEST(NetworkBytes, BeyondTheEndNothingIsWrittenAndNeverAgain) {
  std::array<std::byte, 8> room{};
  ByteWriter sut{std::span(room).first(7)};
  sut.values(std::uint32_t{0xFFFFFFFF});
  sut.values(std::uint16_t{0xFFFF}, std::uint16_t{0xFFFF});
  EXPECT_FALSE(sut.is_good());
  EXPECT_EQ(sut.size(), 4U);
  sut.values(std::uint8_t{0xFF});
  sut.block(std::span(room).first(1));
  EXPECT_FALSE(sut.is_good()) << "there would be room for it";
  EXPECT_EQ(sut.size(), 4U);
  for (std::size_t i = 4; i < room.size(); ++i) EXPECT_EQ(room[i], std::byte{0}) << i;
}

TEST(NetworkBytes, WhatIsReadBeyondTheEndIsZero) {
  const std::array<std::byte, 5> bytes{std::byte{1}, std::byte{2}, std::byte{3}, std::byte{4},
                                       std::byte{5}};
  ByteReader sut(bytes);
  std::uint16_t first = 0;
  std::uint16_t second = 9;
  std::array<std::uint8_t, 2> third{9, 9};
  sut.values(first);
  sut.values(second, third);
  EXPECT_EQ(first, 0x0102);
  EXPECT_FALSE(sut.is_good());
  EXPECT_FALSE(sut.is_refused());
  EXPECT_EQ(second, 0) << "what is taken together is there or not together";
  EXPECT_EQ(third, (std::array<std::uint8_t, 2>{}));
  EXPECT_EQ(sut.left(), 3U);
  sut.values(second);
  EXPECT_EQ(second, 0) << "nor anything behind";
  std::array<std::byte, 2> kept{std::byte{7}, std::byte{7}};
  sut.block(kept);
  EXPECT_EQ(kept[0], std::byte{7});
}

TEST(NetworkBytes, ARefusalEndsTheReading) {
  const std::array<std::byte, 4> bytes{std::byte{1}};
  ByteReader sut(bytes);
  sut.refuse();
  std::uint8_t value = 9;
  sut.values(value);
  EXPECT_EQ(value, 0);
  EXPECT_FALSE(sut.is_good());
  EXPECT_TRUE(sut.is_refused());
}

}  // namespace
}  // namespace thimble::link
