#include "daemon/link/thesis_codec.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <random>
#include <vector>

namespace thimble::link {
namespace {

using coupling::ConstraintPlane;
using coupling::PlaneList;

std::vector<std::byte> bytes(std::initializer_list<unsigned> values) {
  std::vector<std::byte> out;
  for (const unsigned value : values) out.push_back(static_cast<std::byte>(value));
  return out;
}

template <std::size_t Size>
std::vector<std::byte> vector_of(const std::array<std::byte, Size>& array) {
  return {array.begin(), array.end()};
}

// Independent of the codec: divides out sign, exponent and fraction by hand.
std::array<std::byte, 4> big_endian(float value) {
  std::uint32_t word = 0;
  if (std::isnan(value)) {
    word = 0x7FC00000;
  } else if (std::isinf(value)) {
    word = value > 0 ? 0x7F800000 : 0xFF800000;
  } else if (value != 0) {
    int exponent = 0;
    const float fraction = std::frexp(std::abs(value), &exponent);  // 0.5 … 1, normal numbers
    word = static_cast<std::uint32_t>(std::ldexp(fraction, 24)) - 0x800000U;
    word |= static_cast<std::uint32_t>(exponent + 126) << 23U;
    if (value < 0) word |= 0x80000000U;
  }
  return {std::byte(word >> 24U), std::byte((word >> 16U) & 0xFFU), std::byte((word >> 8U) & 0xFFU),
          std::byte(word & 0xFFU)};
}

std::vector<std::byte> reply_of(float x, float y, float z, unsigned directions) {
  std::vector<std::byte> out;
  for (const float value : {x, y, z}) {
    for (const std::byte byte : big_endian(value)) out.push_back(byte);
  }
  out.push_back(static_cast<std::byte>(directions));
  return out;
}

ConstraintPlane wall(std::size_t axis, double sign, double position_m) {
  ConstraintPlane plane;
  plane.normal[axis] = sign;
  plane.offset_m = sign * position_m;
  return plane;
}

const float kNan = std::numeric_limits<float>::quiet_NaN();
const float kInf = std::numeric_limits<float>::infinity();

TEST(ThesisRequest, MatchesTheBytesWrittenByHand) {
  const auto golden =
      bytes({0x3F, 0x80, 0x00, 0x00, 0xC0, 0x20, 0x00, 0x00, 0x41, 0x70, 0x00, 0x00});
  const auto encoded = encode_thesis_request({0.001, -0.0025, 0.015});
  ASSERT_TRUE(encoded.has_value());
  EXPECT_EQ(vector_of(*encoded), golden);
  const auto decoded = decode_thesis_request(golden);
  ASSERT_TRUE(decoded.has_value());
  EXPECT_EQ(*decoded, (Position3{0.001, -0.0025, 0.015}));
}

TEST(ThesisRequest, ComesBackWithinAHalfUnitOfTheLastPlace) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> coordinate(-0.2, 0.2);
  for (int i = 0; i < 10000; ++i) {
    const Position3 hand{coordinate(random), coordinate(random), coordinate(random)};
    const auto decoded = decode_thesis_request(*encode_thesis_request(hand));
    ASSERT_TRUE(decoded.has_value());
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR((*decoded)[axis], hand[axis], 0.2 * 0x1.0p-24 * 1.01);
    }
  }
}

TEST(ThesisRequest, RefusesEverySizeButTwelve) {
  for (std::size_t size = 0; size <= 64; ++size) {
    const std::vector<std::byte> datagram(size, std::byte{0});
    const auto decoded = decode_thesis_request(datagram);
    if (size == 12) {
      EXPECT_TRUE(decoded.has_value());
    } else {
      ASSERT_FALSE(decoded.has_value());
      EXPECT_EQ(decoded.error(), RejectReason::WrongSize);
    }
  }
}

TEST(ThesisRequest, RefusesWhatIsNoPosition) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const float value : {kNan, kInf, -kInf, 10001.0F, -10001.0F, 3e38F}) {
      std::array<float, 3> v{1, 2, 3};
      v[axis] = value;
      std::vector<std::byte> datagram = reply_of(v[0], v[1], v[2], 0);
      datagram.pop_back();
      const auto decoded = decode_thesis_request(datagram);
      ASSERT_FALSE(decoded.has_value());
      EXPECT_EQ(decoded.error(),
                std::isfinite(value) ? RejectReason::OutOfRange : RejectReason::NonFinite);
      Position3 hand{0, 0, 0};
      hand[axis] = static_cast<double>(value) / 1000;
      EXPECT_EQ(encode_thesis_request(hand).has_value(), std::isfinite(value));
    }
  }
}

TEST(ThesisReply, MatchesTheBytesWrittenByHand) {
  // The 3-cell box touched at +x: 15.0, "x <".
  const auto golden = bytes({0x41, 0x70, 0x00, 0x00, 0, 0, 0, 0, 0, 0, 0, 0, 0x01});
  PlaneList planes;
  planes.push_back(wall(0, 1, 0.015));
  const EncodedReply encoded = encode_thesis_reply({0.0152, 0, 0}, planes);
  EXPECT_EQ(vector_of(encoded.bytes), golden);
  EXPECT_EQ(encoded.unencodable, 0U);
  const auto decoded = decode_thesis_reply(golden);
  ASSERT_TRUE(decoded.has_value());
  EXPECT_EQ(*decoded, planes);
}

TEST(ThesisReply, ReadsEachDirectionAsTheRightHalfSpace) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const bool is_less : {true, false}) {
      for (const float position_mm : {15.0F, -15.0F, 0.0F}) {
        const unsigned directions = 1U << (2 * axis + (is_less ? 0 : 1));
        const auto decoded =
            decode_thesis_reply(reply_of(position_mm, position_mm, position_mm, directions));
        ASSERT_TRUE(decoded.has_value());
        ASSERT_EQ(decoded->size(), 1U);
        // "<": 1 mm below is admissible, 1 mm above is not; ">" the other way round.
        for (const double side_m : {-0.001, 0.001}) {
          Position3 hand{};
          hand[axis] = static_cast<double>(position_mm) / 1000 + side_m;
          const ConstraintPlane& plane = (*decoded)[0];
          EXPECT_EQ(dot(plane.normal, hand) <= plane.offset_m, (side_m < 0) == is_less);
        }
      }
    }
  }
}

TEST(ThesisReply, NeverLooksAtAnAxisWithoutDirection) {
  for (const float garbage : {kNan, kInf, -kInf, 3e38F, -1e30F}) {
    const auto decoded = decode_thesis_reply(reply_of(garbage, -15.0F, garbage, 0x08));
    ASSERT_TRUE(decoded.has_value());
    ASSERT_EQ(decoded->size(), 1U);
    EXPECT_EQ((*decoded)[0], wall(1, -1, -0.015));
    const auto none = decode_thesis_reply(reply_of(garbage, garbage, garbage, 0));
    ASSERT_TRUE(none.has_value());
    EXPECT_TRUE(none->empty());
  }
}

TEST(ThesisReply, RefusesNonFiniteAndAbsurdPlanesWhereADirectionIsSet) {
  for (unsigned bit = 0; bit < 6; ++bit) {
    for (const float value : {kNan, kInf, -kInf, 10001.0F, -3e38F}) {
      const auto decoded = decode_thesis_reply(reply_of(value, value, value, 1U << bit));
      ASSERT_FALSE(decoded.has_value());
      EXPECT_EQ(decoded.error(),
                std::isfinite(value) ? RejectReason::OutOfRange : RejectReason::NonFinite);
    }
  }
}

TEST(ThesisReply, TakesExactlyTheTwentySevenDirectionBytesThatCanBe) {
  unsigned taken = 0;
  for (unsigned directions = 0; directions < 256; ++directions) {
    const auto decoded = decode_thesis_reply(reply_of(1, 2, 3, directions));
    const bool is_contradictory = (directions & (directions >> 1U) & 0x15U) != 0;
    const bool is_possible = directions < 64 && !is_contradictory;
    ASSERT_EQ(decoded.has_value(), is_possible) << directions;
    taken += is_possible ? 1U : 0U;
    if (is_possible) {
      EXPECT_EQ(decoded->size(), static_cast<std::size_t>(std::popcount(directions)));
    } else {
      EXPECT_EQ(decoded.error(), RejectReason::BadDirection);
    }
  }
  EXPECT_EQ(taken, 27U);
}

TEST(ThesisReply, RefusesEverySizeButThirteen) {
  for (std::size_t size = 0; size <= 64; ++size) {
    const std::vector<std::byte> datagram(size, std::byte{0});
    EXPECT_EQ(decode_thesis_reply(datagram).has_value(), size == 13) << size;
  }
}

TEST(ThesisReply, ABoundaryBelongsToTheUpperCell) {
  PlaneList planes;
  planes.push_back(wall(1, 1, 0.015));    // "y <"
  planes.push_back(wall(1, -1, -0.015));  // "y >"
  const auto directions = [&](double y_m) {
    return std::to_integer<unsigned>(encode_thesis_reply({0, y_m, 0}, planes).bytes.back());
  };
  EXPECT_EQ(directions(0.0149), 0U);
  EXPECT_EQ(directions(0.015), 0x04U);
  EXPECT_EQ(directions(-0.015), 0U);
  EXPECT_EQ(directions(-0.01501), 0x08U);
}

TEST(ThesisReply, SendsTheInnermostOfSeveralWallsOnOneAxis) {
  PlaneList planes;
  planes.push_back(wall(2, 1, 0.045));
  planes.push_back(wall(2, 1, 0.015));
  planes.push_back(wall(2, 1, 0.030));
  const EncodedReply encoded = encode_thesis_reply({0, 0, 0.05}, planes);
  const auto decoded = decode_thesis_reply(encoded.bytes);
  ASSERT_TRUE(decoded.has_value());
  ASSERT_EQ(decoded->size(), 1U);
  EXPECT_EQ((*decoded)[0], wall(2, 1, 0.015));
}

TEST(ThesisReply, CountsPlanesThatItCannotCarry) {
  PlaneList planes;
  const double half = std::sqrt(0.5);
  planes.push_back({.normal = {half, half, 0}, .offset_m = 0});
  planes.push_back({.normal = {0, 0, 0}, .offset_m = 0});
  planes.push_back({.normal = {std::nan(""), 0, 1}, .offset_m = 0});
  planes.push_back({.normal = {1, 0, 0}, .offset_m = std::nan("")});
  planes.push_back({.normal = {1, 0, 0}, .offset_m = 11});
  planes.push_back(wall(0, 1, 0.001));
  const EncodedReply encoded = encode_thesis_reply({0.002, 0, 0}, planes);
  EXPECT_EQ(encoded.unencodable, 5U);
  EXPECT_EQ(std::to_integer<unsigned>(encoded.bytes.back()), 0x01U);
}

// The server of 1999, from the description of the protocol: cells of 30 mm, ghost in the
// middle cell, every other cell occupied. Exact arithmetic: its own binary32 sum rounds
// within one unit of the last place of a boundary.
std::vector<std::byte> server_of_1999(const std::array<float, 3>& hand_mm) {
  std::array<float, 3> plane{0, 0, 0};
  unsigned directions = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double shifted = static_cast<double>(hand_mm[axis]) + 45.0;
    const int cell = shifted < 30.0 ? 0 : shifted < 60.0 ? 1 : 2;
    if (cell == 2) plane[axis] = 15.0F;
    if (cell == 0) plane[axis] = -15.0F;
    if (cell == 2) directions |= 1U << (2 * axis);
    if (cell == 0) directions |= 2U << (2 * axis);
  }
  return reply_of(plane[0], plane[1], plane[2], directions);
}

TEST(ThesisReply, EqualsTheServerOf1999ByteForByte) {
  std::mt19937 random(8);
  const std::array<float, 7> special{15.0F,
                                     -15.0F,
                                     std::nextafter(15.0F, 0.0F),
                                     std::nextafter(15.0F, 99.0F),
                                     std::nextafter(-15.0F, 0.0F),
                                     std::nextafter(-15.0F, -99.0F),
                                     0.0F};
  std::uniform_real_distribution<float> coordinate(-60, 60);
  PlaneList planes;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    planes.push_back(wall(axis, 1, 0.015));
    planes.push_back(wall(axis, -1, -0.015));
  }
  for (int i = 0; i < 20000; ++i) {
    std::array<float, 3> hand_mm{};
    for (float& value : hand_mm) {
      value = random() % 2 == 0 ? special[random() % special.size()] : coordinate(random);
    }
    std::vector<std::byte> request = reply_of(hand_mm[0], hand_mm[1], hand_mm[2], 0);
    request.pop_back();
    const auto hand = decode_thesis_request(request);
    ASSERT_TRUE(hand.has_value());
    const std::vector<std::byte> expected = server_of_1999(hand_mm);
    ASSERT_EQ(vector_of(encode_thesis_reply(*hand, planes).bytes), expected);
  }
}

}  // namespace
}  // namespace thimble::link
