#include "sim/export/device_verbs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/json.hpp>
#include <memory>
#include <sstream>

#include "sim/export/uhid_plug.hpp"
#include "sim/model/arm/arm_parameters.hpp"
#include "sim/model/arm/phantom_arm_model.hpp"
#include "tests/unit/export/export_bench.hpp"
#include "tests/unit/export/fake_uhid.hpp"

namespace thimble::sim {
namespace {

namespace json = boost::json;

class Panel final : public plugin::ModelPanel {
 public:
  bool press(unsigned number, bool pressed) noexcept override {
    if (number != 5) return false;
    is_down_ = pressed;
    return true;
  }
  [[nodiscard]] std::vector<Reading> readings() const override {
    return {{"line_5", is_down_ ? 1.0 : 0.0}, {"dim", dimness_}};
  }
  bool set_fault(std::string_view name, std::uint32_t number) noexcept override {
    if (name != kDim || number > 9) return false;
    dimness_ = number;
    return true;
  }
  [[nodiscard]] std::vector<Fault> faults() const override {
    return {{kDim, static_cast<std::uint32_t>(dimness_)}};
  }

 private:
  static constexpr std::string_view kDim = "dim";
  bool is_down_{false};
  double dimness_{0};
};

class DeviceVerbsTest : public ::testing::Test {
 protected:
  DeviceVerbsTest() { EXPECT_TRUE(plug_.plug()); }

  static std::string whole(const DeviceVerbs::Reply& reply) {
    std::string text;
    for (std::string piece = reply(); !piece.empty(); piece = reply()) text += piece;
    EXPECT_TRUE(reply().empty());
    return text;
  }
  json::object say(std::string_view line) {
    std::istringstream lines(whole(sut_.execute(line)));
    std::string last;
    for (std::string one; std::getline(lines, one);) last = one;
    return json::parse(last).as_object();
  }
  bool is_taken(std::string_view line) { return say(line).at("ok").as_bool(); }
  [[nodiscard]] double away_from(Position3 point) const { return norm(arm_.truth().tip - point); }

  ExportBench bench_;
  FakeUhid kernel_;
  PhantomArmModel arm_{phantom_vintage_parameters(), {.amplifier_max_a = 3}};
  Panel panel_;
  UhidPlug plug_{kernel_.take_device_end(), arm_, arm_.describe(), bench_.surroundings()};
  DeviceVerbs sut_{arm_.describe(), plug_, {&arm_, &panel_}, bench_.surroundings()};
};

TEST_F(DeviceVerbsTest, TheHandBringsTheTipWhereItIsTold) {
  ASSERT_TRUE(is_taken("move 0.02 0.01 -0.02 0.3"));
  bench_.run_frames(1000);
  EXPECT_LT(away_from({0.02, 0.01, -0.02}), 1e-3);
  ASSERT_TRUE(is_taken("home 0.3"));
  bench_.run_frames(1000);
  EXPECT_LT(away_from(arm_.home_position()), 1e-3);
}

TEST_F(DeviceVerbsTest, TheHandLetsGoAndTakesHoldAgainWhereTheTipIs) {
  ASSERT_TRUE(is_taken("move 0 0 0.03 0.3"));
  bench_.run_frames(1000);
  ASSERT_TRUE(is_taken("let-go"));
  EXPECT_FALSE(say("status").at("held").as_bool());
  ASSERT_TRUE(is_taken("push 0 0 -1"));
  bench_.run_frames(100);
  EXPECT_GT(away_from({0, 0, 0.03}), 2e-3);
  ASSERT_TRUE(is_taken("push 0 0 0"));
  const Position3 there = arm_.truth().tip;
  ASSERT_TRUE(is_taken("move 0 0 0 1"));
  bench_.run_frames(20);
  EXPECT_LT(away_from(there), 0.02) << "no leap";
  bench_.run_frames(1500);
  EXPECT_LT(away_from({0, 0, 0}), 1e-3);
}

TEST_F(DeviceVerbsTest, PullsThePlugAndPutsItBack) {
  EXPECT_FALSE(is_taken("plug"));
  EXPECT_TRUE(is_taken("unplug"));
  EXPECT_FALSE(say("status").at("plugged").as_bool());
  EXPECT_FALSE(is_taken("unplug"));
  EXPECT_TRUE(is_taken("plug"));
  EXPECT_TRUE(say("status").at("plugged").as_bool());
}

TEST_F(DeviceVerbsTest, PullsTheCableAloneOfAnArmThatGoesOn) {
  EXPECT_FALSE(is_taken("plug"));
  bench_.run_frames(1000);
  EXPECT_TRUE(is_taken("pull-cable"));
  EXPECT_FALSE(say("status").at("plugged").as_bool());
  EXPECT_FALSE(is_taken("pull-cable")) << "it is already";
  EXPECT_TRUE(is_taken("unplug")) << "its supply, too";
  EXPECT_FALSE(is_taken("unplug"));
  EXPECT_TRUE(is_taken("plug"));
}

TEST_F(DeviceVerbsTest, PressesButtonsOfTheArmAndOfThePanel) {
  EXPECT_TRUE(is_taken("press 1"));
  EXPECT_EQ(arm_.counters().stylus_presses, 1U);
  EXPECT_TRUE(is_taken("release 1"));
  EXPECT_TRUE(is_taken("press 0"));
  EXPECT_TRUE(is_taken("press 5"));
  EXPECT_EQ(say("status").at("readings").at("line_5").to_number<double>(), 1);
  EXPECT_FALSE(is_taken("press 6"));
}

TEST_F(DeviceVerbsTest, MisbehavesOnDemand) {
  const MonotonicTime now = bench_.clock.now();
  EXPECT_TRUE(is_taken("stall 0.5"));
  EXPECT_TRUE(bench_.misbehaviour.refuses(now + std::chrono::milliseconds(499)));
  EXPECT_TRUE(is_taken("nak 0.5"));
  EXPECT_TRUE(bench_.misbehaviour.is_silent(now + std::chrono::milliseconds(499)));
  EXPECT_TRUE(is_taken("short 1"));
  EXPECT_TRUE(is_taken("short-out 1"));
  std::array<std::uint8_t, 64> room{};
  EXPECT_EQ(bench_.misbehaviour.spoil(room, 14), 7U);
  EXPECT_EQ(bench_.misbehaviour.taken_of(room).size(), 32U);
  bench_.misbehaviour.note_taken(room);
  const json::object trouble = say("status").at("trouble").as_object();
  EXPECT_EQ(trouble, json::object({{"refused", 1},
                                   {"unanswered", 0},
                                   {"corrupted", 0},
                                   {"shortened", 1},
                                   {"babbled", 0},
                                   {"cut", 1},
                                   {"halted", 0},
                                   {"halted_out", 0}}));
  const json::object refused = say("halt 1");
  EXPECT_FALSE(refused.at("ok").as_bool()) << "through uhid";
}

TEST_F(DeviceVerbsTest, TellsInShortWhatItsMotorsDid) {
  bench_.run_frames(20);
  const json::object felt = say("felt 0.0105 0.5");
  EXPECT_EQ(felt.at("frames").to_number<int>(), 11);
  EXPECT_DOUBLE_EQ(felt.at("from_s").to_number<double>(), 0.010);
  EXPECT_DOUBLE_EQ(felt.at("lasted_s").to_number<double>(), 0.010);
  EXPECT_EQ(felt.at("most_newton").to_number<double>(), 0);
  EXPECT_DOUBLE_EQ(felt.at("longest_below_s").to_number<double>(), 0.010);
  DeviceVerbs plain(arm_.describe(), plug_, {nullptr, nullptr}, bench_.surroundings());
  EXPECT_NE(whole(plain.execute("felt")).find("no arm"), std::string::npos);
}

TEST_F(DeviceVerbsTest, DoesWrongWhatItsModelKnowsToAndNamesThatForWhatItDoesNot) {
  EXPECT_TRUE(is_taken("fault dim 4"));
  EXPECT_EQ(say("status").at("readings").at("dim").to_number<double>(), 4);
  EXPECT_EQ(say("status").at("faults").at("dim").to_number<int>(), 4);
  for (const char* line : {"fault dim 10", "fault bright 1"}) {
    const json::object refused = say(line);
    EXPECT_FALSE(refused.at("ok").as_bool()) << line;
    EXPECT_NE(refused.at("error").as_string().find("it has: dim"), std::string::npos) << line;
  }
  DeviceVerbs plain(arm_.describe(), plug_, {nullptr, nullptr}, bench_.surroundings());
  EXPECT_NE(whole(plain.execute("fault dim 4")).find("it has: none"), std::string::npos);
}

TEST_F(DeviceVerbsTest, SaysWhatItIsAndWhereItsTipIs) {
  const json::object status = say("status");
  EXPECT_EQ(status.at("model").as_string(), "sim:phantom-vintage");
  EXPECT_EQ(status.at("tip_m").as_array().size(), 3U);
  EXPECT_FALSE(status.at("open").as_bool());
  EXPECT_EQ(status.at("counters").at("malformed").to_number<int>(), 0);
}

TEST_F(DeviceVerbsTest, TellsTheLogWithItsEntriesCounted) {
  bench_.run_frames(500);
  const json::object end = say("log 0.1");
  EXPECT_TRUE(end.at("ok").as_bool());
  EXPECT_NEAR(end.at("entries").to_number<double>(), 100, 2);
}

TEST_F(DeviceVerbsTest, ALongLogComesInPieces) {
  bench_.run_frames(500);
  const DeviceVerbs::Reply reply = sut_.execute("log 0.4");
  int pieces = 0;
  for (std::string piece = reply(); !piece.empty(); piece = reply()) {
    EXPECT_LE(static_cast<std::size_t>(std::count(piece.begin(), piece.end(), '\n')),
              DeviceVerbs::kLogLinesOfAPiece);
    ++pieces;
    bench_.run_frames(1);
  }
  EXPECT_GT(pieces, 10);
}

TEST_F(DeviceVerbsTest, RefusesWithASentence) {
  const json::object refused = say("jump");
  EXPECT_FALSE(refused.at("ok").as_bool());
  EXPECT_NE(refused.at("error").as_string().find("no such verb"), std::string::npos);
}

TEST_F(DeviceVerbsTest, WhatIsNoArmCannotBeHeld) {
  DeviceVerbs lines(arm_.describe(), plug_, {nullptr, &panel_}, bench_.surroundings());
  EXPECT_NE(whole(lines.execute("move 0 0 0")).find("no arm"), std::string::npos);
  EXPECT_NE(whole(lines.execute("press 0")).find("no button 0"), std::string::npos);
  EXPECT_EQ(whole(lines.execute("status")).find("tip_m"), std::string::npos);
}

}  // namespace
}  // namespace thimble::sim
