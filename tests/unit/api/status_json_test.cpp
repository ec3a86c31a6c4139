#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/json.hpp>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "daemon/api/json_text.hpp"
#include "daemon/api/status.hpp"

namespace thimble::api {
namespace {

namespace json = boost::json;
using testing::HasSubstr;

Status sample() {
  Status status;
  status.version = "0.1.0";
  status.uptime_s = 1.5;
  status.degraded = {"no real-time rights"};
  ArmStatus arm;
  arm.name = "right";
  arm.position_m = {0.001, -0.5, 1e-9};
  arm.contacts = 3;
  arm.is_in_contact = true;
  arm.faults = {{"overspeed", "the tip moved too fast", 1.25, "/f/1.csv", 7}};
  status.arms = {arm};
  status.servos = {ServoStatus{"right", 1000, 5, 1, {1e-6, 2e-6, 3e-6}, {}, {}, true}};
  status.links = {LinkStatus{"right", "", "127.0.0.1:5001", "udp", true, 0.01, 1, 2, 3, 4, 5}};
  status.links[0].events = {{"wrong_size", 7}};
  status.worlds = {WorldStatus{"box", "box:3", {3, 3, 3}, 0.03, 1}};
  return status;
}

std::set<std::string> keys_of(const json::value& value) {
  std::set<std::string> out;
  for (const auto& member : value.as_object()) out.emplace(member.key());
  return out;
}

TEST(StatusJson, TellsTheCellOfTheGhostAndHowWarmAWallIsWhereThatIsKnown) {
  Status status = sample();
  status.arms[0].felt.planes = {{{1, 0, 0}, 0.5}, {{0, 1, 0}, 0.25, 310.5}};
  status.arms[0].felt.ghost_cell = {3, 1, -2};
  const auto sut = json::parse(to_json(status)).at("arms").at(0).at("felt");
  EXPECT_EQ(sut.at("ghost_cell"), (json::array{3, 1, -2}));
  EXPECT_EQ(keys_of(sut.at("planes").at(0)), (std::set<std::string>{"normal", "offset_m"}));
  EXPECT_EQ(sut.at("planes").at(1).at("temperature_kelvin").to_number<double>(), 310.5);
}

TEST(StatusJson, TellsThePressureOfCellsOnlyWhereThereIsOne) {
  Status status = sample();
  const auto felt = [&] { return json::parse(to_json(status)).at("arms").at(0).at("felt"); };
  EXPECT_FALSE(felt().as_object().contains("pressure_newton"));
  status.arms[0].felt.pressure_newton = {-0.5, 0.25, 3.5};
  EXPECT_EQ(felt().at("pressure_newton"), (json::array{-0.5, 0.25, 3.5}));
}

TEST(StatusJson, TellsTheSchemeOfALinkAndWhyThatOne) {
  Status status = sample();
  status.links[0].scheme = "ghost-point";
  status.links[0].scheme_reason = "the world does not go with composite";
  const auto sut = json::parse(to_json(status)).at("links").at(0);
  EXPECT_EQ(sut.at("scheme").as_string(), "ghost-point");
  EXPECT_EQ(sut.at("scheme_reason").as_string(), "the world does not go with composite");
}

TEST(StatusJson, TellsOfABallAndFloorWhereTheWorldIsOne) {
  Status status = sample();
  EXPECT_FALSE(json::parse(to_json(status)).at("worlds").at(0).as_object().contains("sphere"));
  status.worlds[0].sphere = {{0.5, -0.25, 0}, 0.125, -2};
  const auto sut = json::parse(to_json(status)).at("worlds").at(0).at("sphere");
  EXPECT_EQ(keys_of(sut), (std::set<std::string>{"center_m", "radius_m", "floor_m"}));
  EXPECT_EQ(sut.at("center_m").at(1).to_number<double>(), -0.25);
  EXPECT_EQ(sut.at("radius_m").to_number<double>(), 0.125);
  EXPECT_EQ(sut.at("floor_m").to_number<double>(), -2);
}

TEST(StatusJson, TellsOfTheHeldPieceWhereTheWorldHasPieces) {
  Status status = sample();
  EXPECT_FALSE(json::parse(to_json(status)).at("worlds").at(0).as_object().contains("pieces"));
  status.worlds[0].pieces = {5, true, {16, 3, 0}};
  const auto sut = json::parse(to_json(status)).at("worlds").at(0).at("pieces");
  EXPECT_EQ(keys_of(sut), (std::set<std::string>{"held", "is_free_motion", "grasp_cell"}));
  EXPECT_EQ(sut.at("held").to_number<int>(), 5);
  EXPECT_TRUE(sut.at("is_free_motion").as_bool());
  EXPECT_EQ(sut.at("grasp_cell"), (json::array{16, 3, 0}));
}

TEST(StatusJson, TellsWhereTheHandIsFelt) {
  Status status = sample();
  status.arms.at(0).felt = {{0.1, 0.2, 0.3}, 0.05, std::array{0.1, 0.2, 0.25}, {{{0, 0, 1}, 0.25}}};
  const auto sut = json::parse(to_json(status)).at("arms").at(0).at("felt");
  EXPECT_EQ(sut.at("position_m"), (json::array{0.1, 0.2, 0.3}));
  EXPECT_DOUBLE_EQ(sut.at("lag_s").to_number<double>(), 0.05);
  EXPECT_EQ(sut.at("ghost_m"), (json::array{0.1, 0.2, 0.25}));
  ASSERT_EQ(sut.at("planes").as_array().size(), 1U);
  EXPECT_EQ(keys_of(sut.at("planes").at(0)), (std::set<std::string>{"normal", "offset_m"}));
  EXPECT_DOUBLE_EQ(sut.at("planes").at(0).at("offset_m").to_number<double>(), 0.25);
}

TEST(StatusJson, TellsOfTheSafetyLinesWhereThereAreAny) {
  Status status = sample();
  EXPECT_FALSE(json::parse(to_json(status)).as_object().contains("safety"));
  status.safety =
      SafetyStatus{"bench", "stopped", "open", "released it is not", true, false, false, 3};
  const auto sut = json::parse(to_json(status)).at("safety");
  EXPECT_EQ(keys_of(sut), (std::set<std::string>{"chip", "state", "trouble", "message", "stops",
                                                 "is_deadman_held", "must_release_deadman",
                                                 "is_enable_beating"}));
  EXPECT_EQ(sut.at("state").as_string(), "stopped");
  EXPECT_TRUE(sut.at("is_deadman_held").as_bool());
  EXPECT_FALSE(sut.at("must_release_deadman").as_bool());
  EXPECT_EQ(sut.at("stops").to_number<int>(), 3);
  status.safety->must_release_deadman = true;
  EXPECT_TRUE(json::parse(to_json(status)).at("safety").at("must_release_deadman").as_bool());
}

TEST(StatusJson, TellsOfNoRateWhereNobodyKnowsIt) {
  Status status = sample();
  status.servos[0].rate_hz.reset();
  const auto sut = json::parse(to_json(status)).at("servos").at(0);
  EXPECT_FALSE(sut.as_object().contains("rate_hz"));
  EXPECT_EQ(sut.at("ticks").to_number<int>(), 5);
}

TEST(StatusJson, HasTheNamesThatOthersRelyOn) {
  const auto sut = json::parse(to_json(sample()));
  using Names = std::set<std::string>;
  EXPECT_EQ(keys_of(sut),
            (Names{"version", "uptime_s", "degraded", "arms", "servos", "links", "worlds"}));
  EXPECT_EQ(keys_of(sut.at("arms").at(0)), (Names{"name",
                                                  "device",
                                                  "newton_per_count",
                                                  "stands_in_for",
                                                  "model",
                                                  "state",
                                                  "calibration",
                                                  "instruction",
                                                  "position_m",
                                                  "gimbal_rad",
                                                  "force_newton",
                                                  "peak_force_newton",
                                                  "offset_m",
                                                  "peak_offset_m",
                                                  "wished_energy_joule",
                                                  "contacts",
                                                  "faults",
                                                  "is_in_contact",
                                                  "lease",
                                                  "lease_number",
                                                  "constraint_state",
                                                  "world",
                                                  "max_force_newton",
                                                  "felt"}));
  EXPECT_EQ(keys_of(sut.at("arms").at(0).at("felt")), (Names{"position_m", "lag_s", "planes"}));
  EXPECT_EQ(keys_of(sut.at("arms").at(0).at("faults").at(0)),
            (Names{"code", "message", "at_s", "recording", "number"}));
  EXPECT_EQ(
      keys_of(sut.at("servos").at(0)),
      (Names{"arm", "rate_hz", "ticks", "overruns", "wakeup_error_s", "compute_s", "exchange_s",
             "is_realtime", "missed_exchanges", "malformed_reports", "superseded_commands"}));
  EXPECT_EQ(keys_of(sut.at("servos").at(0).at("compute_s")), (Names{"p50", "p99", "max"}));
  EXPECT_EQ(keys_of(sut.at("links").at(0)),
            (Names{"arm", "peer", "kind", "is_up", "round_trip_s", "sent", "received", "lost",
                   "rejected", "stale", "jitter_s", "last_error", "events"}));
  EXPECT_EQ(keys_of(sut.at("worlds").at(0)),
            (Names{"name", "source", "cells", "cell_m", "probes", "occupied_cells", "edits_applied",
                   "edits_waiting"}));
}

TEST(StatusJson, CarriesTheValues) {
  const auto sut = json::parse(to_json(sample()));
  EXPECT_DOUBLE_EQ(sut.at("arms").at(0).at("position_m").at(1).to_number<double>(), -0.5);
  EXPECT_DOUBLE_EQ(sut.at("arms").at(0).at("position_m").at(2).to_number<double>(), 1e-9);
  EXPECT_TRUE(sut.at("arms").at(0).at("gimbal_rad").as_array().empty());
  Status turned = sample();
  turned.arms[0].gimbal_rad = {0.5, -1.25, std::nan("")};
  const auto gimbal = json::parse(to_json(turned)).at("arms").at(0).at("gimbal_rad");
  EXPECT_DOUBLE_EQ(gimbal.at(1).to_number<double>(), -1.25);
  EXPECT_TRUE(gimbal.at(2).is_null());
  EXPECT_EQ(sut.at("arms").at(0).at("contacts").to_number<int>(), 3);
  EXPECT_TRUE(sut.at("arms").at(0).at("is_in_contact").as_bool());
  EXPECT_EQ(sut.at("links").at(0).at("stale").to_number<int>(), 5);
  EXPECT_EQ(sut.at("links").at(0).at("events").at("wrong_size").to_number<int>(), 7);
  EXPECT_DOUBLE_EQ(sut.at("servos").at(0).at("wakeup_error_s").at("max").to_number<double>(), 3e-6);
}

TEST(StatusJson, NeverWritesANumberThatIsNotFinite) {
  Status status = sample();
  status.arms[0].force_newton = {std::nan(""), std::numeric_limits<double>::infinity(), 2};
  status.uptime_s = -std::numeric_limits<double>::infinity();
  const auto sut = json::parse(to_json(status));  // NaN is no JSON: parsing would fail
  EXPECT_TRUE(sut.at("arms").at(0).at("force_newton").at(0).is_null());
  EXPECT_TRUE(sut.at("arms").at(0).at("force_newton").at(1).is_null());
  EXPECT_TRUE(sut.at("uptime_s").is_null());
}

TEST(StatusJson, EscapesWhatDevicesSayOfThemselves) {
  Status status = sample();
  status.arms[0].device = "hid:\"\\\n\x1b";
  EXPECT_EQ(json::parse(to_json(status)).at("arms").at(0).at("device").as_string(),
            status.arms[0].device);
}

TEST(JsonText, IsMadeForReading) {
  const json::value value = {{"a", {{"b", {1.0, 0.25}}}}, {"c", json::array{}}, {"d", nullptr}};
  EXPECT_EQ(to_text(value),
            "{\n  \"a\": {\n    \"b\": [1, 0.25]\n  },\n  \"c\": [],\n  \"d\": null\n}\n");
}

}  // namespace
}  // namespace thimble::api
