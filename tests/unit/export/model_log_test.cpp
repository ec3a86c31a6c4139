#include "sim/export/model_log.hpp"

#include <gtest/gtest.h>

#include <boost/json.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace thimble::sim {
namespace {

namespace json = boost::json;

LogTime at(double s) { return {{from_seconds(s)}, {from_seconds(s + 100)}}; }

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
  const json::object entry = entries(sut.lines_since({})).at(0);
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
  const auto told = entries(sut.lines_since({}));
  EXPECT_EQ(told.at(0).at("out").as_string(), "00ff1a");
  EXPECT_EQ(told.at(1).at("in").as_string(), "00ff1a");
  EXPECT_EQ(told.at(2).at("request").as_string(), "");
}

TEST(ModelLogTest, CutsWhatIsLongerThanAReport) {
  ModelLog sut(10);
  sut.note_bytes(at(1), ModelLog::Direction::ToModel, std::vector<std::uint8_t>(200, 7));
  EXPECT_EQ(entries(sut.lines_since({})).at(0).at("out").as_string().size(),
            2 * bus::kMaxHidReportBytes);
}

TEST(ModelLogTest, ForgetsTheOldestWhenItIsFull) {
  ModelLog sut(5);
  for (int i = 0; i < 12; ++i) sut.note_sample(at(i), {});
  const auto told = entries(sut.lines_since({}));
  ASSERT_EQ(told.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_DOUBLE_EQ(told[i].at("t_s").to_number<double>(), 7.0 + static_cast<double>(i));
  }
}

TEST(ModelLogTest, TellsOnlyWhatIsAskedFor) {
  ModelLog sut(100);
  for (int i = 0; i < 50; ++i) sut.note_sample(at(i), {});
  EXPECT_EQ(entries(sut.lines_since({from_seconds(45)})).size(), 5U);
  EXPECT_TRUE(sut.lines_since({from_seconds(50)}).empty());
}

}  // namespace
}  // namespace thimble::sim
