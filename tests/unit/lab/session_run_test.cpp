#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "lab/run/playable.hpp"
#include "lab/run/run.hpp"

namespace thimble::lab {
namespace {

std::unique_ptr<SessionRun> played(const std::vector<std::string>& overrides, double for_s,
                                   std::optional<std::uint64_t> seed = {}) {
  auto run = SessionRun::load({.file = THIMBLE_SOURCE_DIR "/tests/data/hello.toml",
                               .overrides = overrides,
                               .seed = seed,
                               .for_s = for_s});
  if (!run) {
    ADD_FAILURE() << run.error().message;
    return nullptr;
  }
  (*run)->play();
  return *std::move(run);
}

std::uint64_t hash_of(const std::vector<std::string>& overrides,
                      std::optional<std::uint64_t> seed = {}) {
  const auto run = played(overrides, 3, seed);
  return run ? run->trace(0).hash.value() : 0;
}

TEST(SessionRun, TheArmOfTheBoxIsDrivenAndFindsItsWalls) {
  const auto run = played({}, 8);
  ASSERT_NE(run, nullptr);
  const Findings findings = run->findings();
  EXPECT_TRUE(findings.is_met()) << tell(findings);
  const servo::ServoSnapshot& last = run->session().arm(0).session().snapshot();
  EXPECT_GT(last.total_contacts, 0U);
  EXPECT_EQ(last.frame.state, OperatingState::Active);
  EXPECT_GT(run->trace(0).driven_s, 5);
  EXPECT_EQ(findings.tables.size(), 2U);
  EXPECT_LE(findings.tables[1].rows.size(), SessionRun::kMostRows);
  EXPECT_GT(findings.tables[1].rows.size(), SessionRun::kMostRows / 4);
  for (const auto& row : findings.tables[1].rows) {
    ASSERT_EQ(row.size(), findings.tables[1].columns.size());
  }
  EXPECT_EQ(tell(findings).find("velocity"), std::string::npos) << "traces are for files";
}

TEST(SessionRun, TheSameSeedGivesTheSameTraceAndAnotherDoesNot) {
  const std::uint64_t as_the_file_says = hash_of({});
  EXPECT_EQ(hash_of({}), as_the_file_says);
  EXPECT_EQ(hash_of({}, 1), as_the_file_says) << "the file says 1";
  EXPECT_NE(hash_of({}, 2), as_the_file_says);
  // Composite knows the box beforehand, and feels nothing of a network.
  const std::vector<std::string> network{"arm.coupling.scheme='ghost-point'",
                                         "arm.impairment.delay_s=0.04",
                                         "arm.impairment.jitter_s=0.02"};
  EXPECT_NE(hash_of(network), as_the_file_says);
  EXPECT_EQ(hash_of(network, 3), hash_of(network, 3));
}

TEST(SessionRun, EverySchemePlays) {
  for (const char* scheme : {"ghost-point", "thesis-literal", "remote-force", "spring-damper",
                             "wave", "constraint-plane", "buffer-zone", "composite"}) {
    const auto run = played({std::string("arm.coupling.scheme='") + scheme + "'"}, 2);
    ASSERT_NE(run, nullptr) << scheme;
    EXPECT_GT(run->trace(0).driven_s, 0.5) << scheme;
  }
}

TEST(SessionRun, AFaultIsToldByTheVerdict) {
  const auto run = played({"arm.limits.overspeed_m_per_s=0.01"}, 3);
  ASSERT_NE(run, nullptr);
  EXPECT_FALSE(run->findings().is_met());
}

TEST(SessionRun, MistakesOfTheFileAreTold) {
  const auto none = SessionRun::load({.file = "/nowhere.toml", .overrides = {}, .seed = {}});
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("/nowhere.toml"), std::string::npos);
  const auto wrong = SessionRun::load({.file = THIMBLE_SOURCE_DIR "/tests/data/hello.toml",
                                       .overrides = {"arm.speed=3", "servo.rate_hz='x'"},
                                       .seed = {}});
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().message.find("arm.speed"), std::string::npos);
  EXPECT_NE(wrong.error().message.find("servo.rate_hz"), std::string::npos);
}

// A configuration of which all can be played, and what each change makes of it.
TEST(ReasonsNotToPlay, NameEachThingThatKeepsRealTime) {
  config::Config config;
  EXPECT_EQ(reasons_not_to_play(config).size(), 1U) << "no arm";
  config.arms.emplace_back();
  config.arms[0].name = "right";
  config.arms[0].device = "sim:phantom-vintage";
  config.arms[0].world = "box";
  config.worlds.emplace_back();
  config.worlds[0].name = "box";
  EXPECT_TRUE(reasons_not_to_play(config).empty());
  const auto expect_reason = [](const config::Config& changed, const std::string& key) {
    const auto reasons = reasons_not_to_play(changed);
    ASSERT_EQ(reasons.size(), 1U) << key;
    EXPECT_NE(reasons[0].find(key + ": "), std::string::npos) << reasons[0];
  };
  config::Config changed = config;
  changed.arms[0].device = "hid:1234";
  expect_reason(changed, "device");
  changed = config;
  changed.arms[0].link = config::UdpEndpoint{"127.0.0.1", 5001};
  expect_reason(changed, "link");
  changed = config;
  changed.worlds[0].listen = config::UdpEndpoint{"127.0.0.1", 5001};
  expect_reason(changed, "listen");
  changed = config;
  changed.worlds[0].pieces = config::PiecesConfig{.board = config::PieceBoardKind::Pci};
  expect_reason(changed, "pieces.board");
  changed.worlds[0].pieces->board = config::PieceBoardKind::SimUsb;
  EXPECT_TRUE(reasons_not_to_play(changed).empty());
  changed = config;
  changed.safety = config::SafetyConfig{};
  expect_reason(changed, "safety");
}

}  // namespace
}  // namespace thimble::lab
