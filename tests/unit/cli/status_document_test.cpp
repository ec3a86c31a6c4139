#include "cli/status_document.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "tests/unit/cli/sample_status.hpp"

namespace thimble::cli {
namespace {

TEST(StatusDocument, IsReadBackAsTheDaemonWroteIt) {
  api::Status status = sample_status();
  for (const bool has_gimbal : {false, true}) {
    if (has_gimbal) status.arms[0].gimbal_rad = {0.5, -1.25, 3};
    if (has_gimbal) status.servos[0].rate_hz.reset();
    if (has_gimbal) status.arms[0].wished_energy_joule = -0.25;
    if (has_gimbal) status.arms[0].felt.ghost_cell = {-3, 0, 7};
    if (has_gimbal) status.arms[0].felt.pressure_newton = {-0.5, 0.25, 3};
    if (has_gimbal) status.arms[0].felt.planes[0].temperature_kelvin = 310.5;
    if (has_gimbal) status.worlds[0].sphere = {{0, -0.25, 1}, 0.5, -10};
    if (has_gimbal) status.worlds[0].pieces = {7, true, {1, 20, 300}};
    if (has_gimbal)
      status.safety = {"bench", "stopped", "open", "it is pressed", false, true, true, 7};
    const auto sut = parse_status(api::to_json(status));
    ASSERT_TRUE(sut);
    EXPECT_EQ(*sut, status);
  }
}

TEST(StatusDocument, RefusesWhatIsNoObject) {
  for (const char* bytes : {"", "{", "[]", "3", "null", "{\"a\": nan}", "\x00"}) {
    EXPECT_FALSE(parse_status(bytes)) << bytes;
  }
}

// What `thimble report` is given may be any program's.
TEST(StatusDocument, RefusesAnObjectWithoutVersionAndArms) {
  for (const char* bytes :
       {"{}", R"({"arms": []})", R"({"version": 1, "arms": []})", R"({"version": "", "arms": []})",
        R"({"version": "1", "arms": {}})", R"({"name": "left-pad", "version": "1.0.0"})"}) {
    const auto sut = parse_status(bytes);
    ASSERT_FALSE(sut) << bytes;
    EXPECT_EQ(sut.error().code, Errc::Malformed);
  }
}

TEST(StatusDocument, TakesMissingAndMistypedMembersAsUnknown) {
  const auto sut = parse_status(
      R"({"version": "1", "uptime_s": "x", "arms": [3, {"position_m": [1, null], "contacts": -2, "faults": {}}]})");
  ASSERT_TRUE(sut);
  EXPECT_TRUE(std::isnan(sut->uptime_s));
  ASSERT_EQ(sut->arms.size(), 2U);
  EXPECT_EQ(sut->arms[1].position_m[0], 1);
  EXPECT_TRUE(std::isnan(sut->arms[1].position_m[1]));
  EXPECT_TRUE(std::isnan(sut->arms[1].position_m[2]));
  EXPECT_EQ(sut->arms[1].contacts, 0U);
}

TEST(StatusDocument, TakesACellThatCannotBeForNone) {
  for (const char* cell : {"3", "[]", "[1, 2]", "[1, 2, null]", "[1e30, 0, 0]", "[0, -1e10, 0]"}) {
    const auto sut = parse_status(R"({"version": "1", "arms": [{"felt": {"ghost_cell": )" +
                                  std::string(cell) + "}}]}");
    ASSERT_TRUE(sut) << cell;
    EXPECT_FALSE(sut->arms[0].felt.ghost_cell) << cell;
  }
}

TEST(StatusDocument, TakesABallThatCannotBeForNone) {
  for (const char* sphere : {"3", "{}", R"({"center_m": [0, 0, 0], "radius_m": 0, "floor_m": 0})",
                             R"({"center_m": [0, 0], "radius_m": 1, "floor_m": 0})",
                             R"({"center_m": [0, 0, null], "radius_m": 1, "floor_m": 0})",
                             R"({"center_m": [1e308, 1e308, 0], "radius_m": 1, "floor_m": 0})"}) {
    const auto sut = parse_status(R"({"version": "1", "arms": [], "worlds": [{"sphere": )" +
                                  std::string(sphere) + "}]}");
    ASSERT_TRUE(sut) << sphere;
    EXPECT_FALSE(sut->worlds[0].sphere) << sphere;
  }
}

TEST(StatusDocument, BoundsItsLists) {
  std::string text = R"({"version": "1", "arms": [], "degraded": [)";
  for (int i = 0; i < 5000; ++i) text += i == 0 ? "\"a\"" : ",\"a\"";
  const auto sut = parse_status(text + "]}");
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->degraded.size(), 1024U);
}

TEST(StatusDocument, KeepsAsManyArmsAndWorldsAsADaemonHas) {
  api::Status status = sample_status();
  const api::ArmStatus arm = status.arms.front();
  const api::WorldStatus world = status.worlds.front();
  for (int i = 1; i < 96; ++i) {
    status.arms.push_back(arm);
    status.worlds.push_back(world);
    status.arms.back().name = status.worlds.back().name = "a" + std::to_string(i);
  }
  const auto sut = parse_status(api::to_json(status));
  ASSERT_TRUE(sut);
  ASSERT_EQ(sut->arms.size(), 96U);
  ASSERT_EQ(sut->worlds.size(), 96U);
  EXPECT_EQ(sut->arms.back().name, "a95");
  EXPECT_EQ(sut->worlds.back().name, "a95");
}

TEST(StatusDocument, SurvivesEveryDamagedByte) {
  const std::string good = api::to_json(sample_status());
  std::mt19937 random(1);  // seeded: the same damage in every run
  for (int round = 0; round < 2000; ++round) {
    std::string bytes = good;
    bytes[random() % bytes.size()] = static_cast<char>(random());
    bytes.resize(bytes.size() - (round % 3 == 0 ? random() % bytes.size() : 0));
    const auto sut = parse_status(bytes);
    if (!sut) {
      EXPECT_EQ(sut.error().code, Errc::Malformed);
    }
  }
}

TEST(ErrorDocument, GivesItsSentenceOrTheOther) {
  EXPECT_EQ(parse_error_message(R"({"error": {"code": "x", "message": "held"}})", "?"), "held");
  for (const char* bytes : {"", "{}", R"({"error": 3})", R"({"error": {"message": 3}})"}) {
    EXPECT_EQ(parse_error_message(bytes, "?"), "?");
  }
}

}  // namespace
}  // namespace thimble::cli
