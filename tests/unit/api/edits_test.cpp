#include "daemon/api/edits.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "daemon/api/server.hpp"

namespace thimble::api {
namespace {

using Kind = CellEdit::Kind;

tl::expected<std::vector<CellEdit>, RequestError> edits_in(std::string_view body) {
  return parse_request("POST", "/v1/worlds/box/edits", body).map([](const Action& action) {
    return action.edits;
  });
}

std::string refusal_of(std::string_view body) {
  const auto sut = edits_in(body);
  if (sut) return "";
  EXPECT_EQ(sut.error().http_status, 400U);
  EXPECT_EQ(sut.error().code, "malformed");
  return sut.error().message;
}

TEST(ApiEdits, ReadsEachKindAlone) {
  EXPECT_EQ(edits_in(R"({"fill": {"min": [0, 1, 2], "max": [3, 4, 5]}})"),
            (std::vector<CellEdit>{{Kind::Fill, {0, 1, 2}, {3, 4, 5}, {}, 0, 1}}));
  EXPECT_EQ(edits_in(R"({"clear": {"min": [0, 0, 0], "max": [1, 1, 1]}})"),
            (std::vector<CellEdit>{{Kind::Fill, {}, {1, 1, 1}, {}, 0, 0}}));
  EXPECT_EQ(edits_in(R"({"box": {"min": [0, 0, 0], "max": [9, 9, 9], "cell": 3}})"),
            (std::vector<CellEdit>{{Kind::Box, {}, {9, 9, 9}, {}, 0, 3}}));
  EXPECT_EQ(edits_in(R"({"paint": {"center_m": [0.01, -2e-3, 1], "radius_m": 1, "cell": 0}})"),
            (std::vector<CellEdit>{{Kind::Paint, {}, {}, {0.01, -0.002, 1}, 1, 0}}));
}

TEST(ApiEdits, ReadsAListInItsOrder) {
  const auto sut = edits_in(
      R"([{"clear": {"min": [0, 0, 0], "max": [1, 1, 1]}},
          {"paint": {"center_m": [0, 0, 0], "radius_m": 0.01}}])");
  ASSERT_TRUE(sut);
  ASSERT_EQ(sut->size(), 2U);
  EXPECT_EQ((*sut)[0].cell, 0);
  EXPECT_EQ((*sut)[1].kind, Kind::Paint);
}

TEST(ApiEdits, NamesTheKeyThatIsWrong) {
  EXPECT_EQ(refusal_of("{"), "the body is no JSON");
  EXPECT_EQ(refusal_of(R"({"fill": {"min": [0, 0], "max": [1, 1, 1]}})"),
            "fill.min: expected three whole numbers from 0");
  EXPECT_EQ(refusal_of(R"({"box": {"min": [0, 0, 0], "max": [1, 1, 1.5]}})"),
            "box.max: expected three whole numbers from 0");
  EXPECT_EQ(refusal_of(R"({"fill": {"min": [0, 0, -1], "max": [1, 1, 1]}})"),
            "fill.min: expected three whole numbers from 0");
  EXPECT_EQ(refusal_of(R"({"fill": {"min": [0, 0, 0]}})"),
            "fill.max: expected three whole numbers from 0");
  EXPECT_EQ(refusal_of(R"({"paint": {"center_m": [0, 0, 0], "radius_m": 0}})"),
            "paint.radius_m: expected a number above 0");
  EXPECT_EQ(refusal_of(R"({"paint": {"center_m": [0, 0, 1e999], "radius_m": 1}})"),
            "paint.center_m: expected three numbers");
  EXPECT_TRUE(refusal_of(R"({"fill": {"min": [0, 0, 0], "max": [1, 1, 1], "cell": 256}})")
                  .starts_with("fill.cell: expected a whole number"));
  EXPECT_TRUE(refusal_of(R"([{"clear": {"min": [0, 0, 0], "max": [1, 1, 1]}}, 3])")
                  .starts_with("edit 1: expected an edit such as"));
}

TEST(ApiEdits, RefusesWhatItDoesNotKnow) {
  for (const char* body : {"", "null", "3", "[]", "{}", R"({"smooth": {}})", R"({"fill": 3})",
                           R"({"fill": {}, "box": {}})",
                           R"({"clear": {"min": [0, 0, 0], "max": [1, 1, 1], "cell": 1}})",
                           R"({"fill": {"min": [0, 0, 0], "max": [1, 1, 1], "": 1}})",
                           R"({"fill": {"min": [0, 0, 0], "max": [1, 1, 1], "sell": 1}})"}) {
    EXPECT_NE(refusal_of(body), "") << body;
  }
}

TEST(ApiEdits, TakesNoMoreThanItsLimit) {
  std::string list;
  for (std::size_t i = 0; i < kMaxEdits; ++i) {
    list += (i == 0 ? "" : ",") + std::string(R"({"clear":{"min":[0,0,0],"max":[1,1,1]}})");
  }
  const auto sut = edits_in("[" + list + "]");
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->size(), kMaxEdits);
  EXPECT_NE(refusal_of("[" + list + R"(,{"clear":{"min":[0,0,0],"max":[1,1,1]}}])"), "");
}

TEST(ApiEdits, SoManyOfTheLongestFitIntoTheBodyThatTheServerReads) {
  const std::string number = "-1.2345678901234567e-300";
  const std::string paint = R"({"paint":{"center_m":[)" + number + "," + number + "," + number +
                            R"(],"radius_m":1.2345678901234567e-300,"cell":255}})";
  std::string body = "[" + paint;
  for (std::size_t i = 1; i < kMaxEdits; ++i) body += "," + paint;
  body += "]";
  EXPECT_LE(body.size(), ServerSettings().max_body_bytes);
  const auto sut = edits_in(body);
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->size(), kMaxEdits);
}

TEST(ApiEdits, AnyBytesGiveEditsOrOneSentence) {
  std::mt19937 random(2);
  const std::string seed = R"([{"box":{"min":[0,0,0],"max":[9,9,9],"cell":3}}])";
  for (int i = 0; i < 20000; ++i) {
    std::string body = seed;
    for (int j = 0; j < 3; ++j) body[random() % body.size()] = static_cast<char>(random() % 256);
    const auto sut = edits_in(body);
    if (sut) {
      EXPECT_LE(sut->size(), kMaxEdits);
    } else {
      EXPECT_FALSE(sut.error().message.empty());
      EXPECT_EQ(sut.error().message.find('\n'), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace thimble::api
