#include "sim/export/model_log.hpp"

#include <gtest/gtest.h>

#include <boost/json.hpp>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

namespace thimble::sim {
namespace {

namespace json = boost::json;

LogTime at(double s) { return {{from_seconds(s)}, {from_seconds(s + 100)}}; }

std::string lines_since(const ModelLog& log, MonotonicTime from) {
  ModelLog::Cursor cursor = log.since(from);
  return log.lines(cursor, 1'000'000);
}

std::vector<json::object> entries(const std::string& lines) {
  std::vector<json::object> parsed;
  std::istringstream in(lines);
  for (std::string line; std::getline(in, line);) parsed.push_back(json::parse(line).as_object());
  return parsed;
}

TEST(ModelLogTest, TellsWhatTheArmFelt) {
  ModelLog sut(10);
  plugin::ArmTruth truth;
  truth.tip = {0.01, -0.02, 0.03};
  truth.motor_force = {1.5, 0, -2};
  truth.motor_current_a = {0.1, 0.2, -0.3};
  truth.is_amplifier_on = true;
  sut.note_sample(at(1.25), truth);
  const json::object entry = entries(lines_since(sut, {})).at(0);
  EXPECT_DOUBLE_EQ(entry.at("t_s").to_number<double>(), 1.25);
  EXPECT_DOUBLE_EQ(entry.at("machine_s").to_number<double>(), 101.25);
  EXPECT_DOUBLE_EQ(entry.at("tip_m").at(1).to_number<double>(), -0.02);
  EXPECT_DOUBLE_EQ(entry.at("force_newton").at(0).to_number<double>(), 1.5);
  EXPECT_DOUBLE_EQ(entry.at("current_a").at(2).to_number<double>(), -0.3);
  EXPECT_TRUE(entry.at("amplifier_on").as_bool());
}

TEST(ModelLogTest, TellsBytesByTheirDirection) {
  ModelLog sut(10);
  const std::vector<std::uint8_t> bytes{0x00, 0xFF, 0x1A};
  sut.note_bytes(at(1), ModelLog::Direction::ToModel, bytes);
  sut.note_bytes(at(2), ModelLog::Direction::ToHost, bytes);
  sut.note_bytes(at(3), ModelLog::Direction::Requested, {});
  const auto told = entries(lines_since(sut, {}));
  EXPECT_EQ(told.at(0).at("out").as_string(), "00ff1a");
  EXPECT_EQ(told.at(1).at("in").as_string(), "00ff1a");
  EXPECT_EQ(told.at(2).at("request").as_string(), "");
}

TEST(ModelLogTest, CutsWhatIsLongerThanAReport) {
  ModelLog sut(10);
  sut.note_bytes(at(1), ModelLog::Direction::ToModel, std::vector<std::uint8_t>(200, 7));
  EXPECT_EQ(entries(lines_since(sut, {})).at(0).at("out").as_string().size(),
            2 * bus::kMaxHidReportBytes);
}

TEST(ModelLogTest, ForgetsTheOldestWhenItIsFull) {
  ModelLog sut(5);
  for (int i = 0; i < 12; ++i) sut.note_sample(at(i), {});
  const auto told = entries(lines_since(sut, {}));
  ASSERT_EQ(told.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_DOUBLE_EQ(told[i].at("t_s").to_number<double>(), 7.0 + static_cast<double>(i));
  }
}

TEST(ModelLogTest, TellsInPiecesWhatWasThereWhenItWasAsked) {
  ModelLog sut(20);
  for (int i = 0; i < 10; ++i) sut.note_sample(at(i), {});
  ModelLog::Cursor cursor = sut.since({});
  EXPECT_EQ(entries(sut.lines(cursor, 4)).size(), 4U);
  for (int i = 10; i < 26; ++i) sut.note_sample(at(i), {});
  const auto rest = entries(sut.lines(cursor, 100));
  ASSERT_EQ(rest.size(), 4U) << "two were overwritten, and what came later was not asked for";
  EXPECT_DOUBLE_EQ(rest[0].at("t_s").to_number<double>(), 6);
  EXPECT_TRUE(sut.lines(cursor, 100).empty());
  EXPECT_EQ(cursor.told, 8U);
}

TEST(ModelLogTest, PrintsEveryNumberAsJson) {
  ModelLog sut(10);
  plugin::ArmTruth truth;
  truth.tip = {-0.00000005, -1e300, 123456.7654321};
  truth.motor_force = {std::nan(""), INFINITY, -0.9999999999};
  sut.note_sample(at(0.0000001), truth);
  const json::object entry = entries(lines_since(sut, {})).at(0);
  EXPECT_DOUBLE_EQ(entry.at("t_s").to_number<double>(), 1e-7);
  EXPECT_NEAR(entry.at("tip_m").at(0).to_number<double>(), 0, 1e-7);
  EXPECT_DOUBLE_EQ(entry.at("tip_m").at(1).to_number<double>(), -1e9);
  EXPECT_DOUBLE_EQ(entry.at("tip_m").at(2).to_number<double>(), 123456.7654321);
  EXPECT_TRUE(entry.at("force_newton").at(0).is_null());
  EXPECT_TRUE(entry.at("force_newton").at(1).is_null());
  EXPECT_DOUBLE_EQ(entry.at("force_newton").at(2).to_number<double>(), -1);
}

TEST(ModelLogTest, TellsInShortWhatWasFeltAndTheLongestHole) {
  ModelLog sut(100);
  EXPECT_EQ(sut.felt({}, 0).frames, 0U);
  plugin::ArmTruth truth;
  // 3 N but for two holes: frames 2 to 4, of 1 N, and 7.
  for (int frame = 0; frame < 10; ++frame) {
    const bool is_hole = (frame >= 2 && frame <= 4) || frame == 7;
    truth.motor_force = {0, is_hole ? 1.0 : 3.0, 0};
    sut.note_sample(at(0.001 * frame), truth);
    sut.note_bytes(at(0.001 * frame), ModelLog::Direction::ToHost, {});
  }
  const ModelLog::Felt all = sut.felt({}, 2);
  EXPECT_EQ(all.frames, 10U);
  EXPECT_DOUBLE_EQ(seconds(all.lasted), 0.009);
  EXPECT_EQ(all.least_newton, 1);
  EXPECT_EQ(all.most_newton, 3);
  EXPECT_DOUBLE_EQ(seconds(all.longest_below), 0.004) << "from frame 1 to frame 5";
  EXPECT_DOUBLE_EQ(seconds(sut.felt({}, 0.5).longest_below), 0.001);
  EXPECT_DOUBLE_EQ(seconds(sut.felt({}, 3).longest_below), 0.009) << "never above";
  const ModelLog::Felt late = sut.felt({from_seconds(0.004)}, 2);
  EXPECT_EQ(late.frames, 6U);
  EXPECT_DOUBLE_EQ(seconds(late.longest_below), 0.002) << "round frame 7";
  EXPECT_DOUBLE_EQ(seconds(late.first.since_epoch), 0.004);
}

TEST(ModelLogTest, OfWhatItForgotItFeelsNothing) {
  ModelLog sut(4);
  plugin::ArmTruth truth;
  for (int frame = 0; frame < 10; ++frame) {
    truth.motor_force = {frame < 6 ? 9.0 : 1.0, 0, 0};
    sut.note_sample(at(0.001 * frame), truth);
  }
  const ModelLog::Felt felt = sut.felt({}, 0);
  EXPECT_EQ(felt.frames, 4U);
  EXPECT_EQ(felt.most_newton, 1);
  EXPECT_DOUBLE_EQ(seconds(felt.first.since_epoch), 0.006);
}

TEST(ModelLogTest, TellsOnlyWhatIsAskedFor) {
  ModelLog sut(100);
  for (int i = 0; i < 50; ++i) sut.note_sample(at(i), {});
  EXPECT_EQ(entries(lines_since(sut, {from_seconds(45)})).size(), 5U);
  EXPECT_TRUE(lines_since(sut, {from_seconds(50)}).empty());
}

}  // namespace
}  // namespace thimble::sim
