#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "lab/run/run.hpp"

namespace thimble::lab {
namespace {

std::unique_ptr<SessionRun> played(const std::vector<std::string>& overrides, double for_s,
                                   std::optional<std::uint64_t> seed = {}) {
  auto run = SessionRun::load({.files = {THIMBLE_SOURCE_DIR "/tests/data/hello.toml"},
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
  const auto text = std::find_if(findings.parameters.begin(), findings.parameters.end(),
                                 [](const Parameter& p) { return p.name == "configuration"; });
  ASSERT_NE(text, findings.parameters.end());
  EXPECT_NE(std::get<std::string>(text->value).find("[[arm]]"), std::string::npos);
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
  const auto none = SessionRun::load({.files = {"/nowhere.toml"}, .overrides = {}, .seed = {}});
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("/nowhere.toml"), std::string::npos);
  const auto wrong = SessionRun::load({.files = {THIMBLE_SOURCE_DIR "/tests/data/hello.toml"},
                                       .overrides = {"arm.speed=3", "servo.rate_hz='x'"},
                                       .seed = {}});
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().message.find("arm.speed"), std::string::npos);
  EXPECT_NE(wrong.error().message.find("servo.rate_hz"), std::string::npos);
}

std::unique_ptr<SessionRun> played_examples(const std::vector<std::string>& names, double for_s,
                                            const std::vector<std::string>& overrides = {}) {
  RunSettings settings{.files = {}, .overrides = overrides, .seed = {}, .for_s = for_s};
  for (const std::string& name : names) {
    settings.files.push_back(THIMBLE_SOURCE_DIR "/examples/" + name + ".toml");
  }
  auto run = SessionRun::load(settings);
  if (!run) {
    ADD_FAILURE() << run.error().message;
    return nullptr;
  }
  (*run)->play();
  return *std::move(run);
}

const std::vector<std::string> kTeleoperation{"teleoperation-host", "teleoperation-guest"};

double x_m(const servo::ServoFrame& frame) { return std::abs(frame.tip.x); }
double newton(const servo::ServoFrame& frame) { return norm(frame.force); }

template <class Measure>
double most(const SessionRun& run, std::size_t arm, const Measure& measure) {
  double out = 0;
  for (const servo::ServoFrame& frame : run.trace(arm).frames) out = std::max(out, measure(frame));
  return out;
}

// 5.3.5: one arm is drawn along by the other, through the datagrams of the daemons, by each of the
// couplings of the thesis: (b), (c), and (e) whose other arm is that of (b).
TEST(SessionRun, HostsThatAreCoupledArePlayedTogether) {
  for (const auto& [here, there] : {std::pair{"wave", "wave"},
                                    {"spring-damper", "spring-damper"},
                                    {"spring-damper", "ghost-point"}}) {
    SCOPED_TRACE(there);
    const auto run =
        played_examples(kTeleoperation, 6,
                        {std::string("teleoperation-host:arm.coupling.scheme='") + here + "'",
                         std::string("teleoperation-guest:arm.coupling.scheme='") + there + "'"});
    ASSERT_NE(run, nullptr);
    ASSERT_EQ(run->session().arms(), 2U);
    const Findings findings = run->findings();
    EXPECT_TRUE(findings.is_met()) << tell(findings);
    EXPECT_EQ(findings.tables[0].rows[0][0], Cell("teleoperation-host: here"));
    EXPECT_EQ(findings.tables[0].rows[1][0], Cell("teleoperation-guest: there"));
    EXPECT_GT(most(*run, 0, x_m), 0.01) << "the hand that holds still is drawn along";
    EXPECT_GT(most(*run, 0, newton), 0.3) << "by a force";
    EXPECT_GT(most(*run, 1, newton), 0.3) << "that the other hand feels";
    const link::LinkStatus link = run->session().arm(1).link_status();
    EXPECT_NEAR(seconds(link.round_trip), 0.04, 0.003) << "as its impairment says";
    EXPECT_GT(link.counters.accepted, 4000U);
  }
}

TEST(SessionRun, HostsThatAreCoupledGiveTheSameTraceAgain) {
  const auto hashes = [](const std::vector<std::string>& overrides) {
    const auto run = played_examples(kTeleoperation, 2, overrides);
    return run ? std::vector{run->trace(0).hash.value(), run->trace(1).hash.value()}
               : std::vector<std::uint64_t>{};
  };
  const auto first = hashes({});
  EXPECT_EQ(hashes({}), first);
  EXPECT_NE(hashes({"teleoperation-guest:arm.impairment.delay_s=0.1"}), first);
}

// Both push the same block, which is in a world of one of them.
TEST(SessionRun, AnArmFeelsTheWorldOfAnotherFile) {
  const auto run = played_examples({"block-host", "block-guest"}, 8);
  ASSERT_NE(run, nullptr);
  EXPECT_TRUE(run->findings().is_met());
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_GT(run->session().arm(i).session().snapshot().total_contacts, 0U) << i;
  }
}

// The column `listen` of docs/worlds-and-schemes.md, by our own datagrams.
TEST(SessionRun, AnArmFeelsEachWorldThatListens) {
  const std::string of_world = "world-host:world.";
  const std::string cells = of_world + "automaton.cells=32";
  const std::string pace = of_world + "automaton.steps_per_s=2";
  const std::vector<std::vector<std::string>> worlds{
      {of_world + "source='box:3'"},
      {of_world + "source='sphere'"},
      {of_world + "source='block'", of_world + "block.room_m=0.05", of_world + "block.edge_m=0.01"},
      {of_world + "source='pieces'", of_world + "pieces.cells=32", of_world + "pieces.count=3"},
      {of_world + "source='life'", cells, pace},
      {of_world + "source='crystal'", cells, pace},
      {of_world + "source='crystal'", cells, of_world + "automaton.axes=3",
       of_world + "automaton.fill_fraction=0.1", of_world + "automaton.steps_per_s=10"},
      {of_world + "source='" THIMBLE_SOURCE_DIR "/examples/gem.obj'",
       of_world + "field.longest_m=0.04", of_world + "field.center_m=[0.03, 0, 0]"}};
  for (const auto& world : worlds) {
    SCOPED_TRACE(world.front() + ", " + world.back());
    std::vector<std::string> said{"arm-host:arm.protocol='thimble'",
                                  "arm-host:arm.hand.reach_m=0.03"};
    said.insert(said.end(), world.begin(), world.end());
    const auto run = played_examples({"world-host", "arm-host"}, 8, said);
    ASSERT_NE(run, nullptr);
    EXPECT_TRUE(run->findings().is_met());
    EXPECT_GT(run->session().arm(0).session().snapshot().total_contacts, 0U);
  }
  const auto shapes = played_examples(
      {"shapes", "arm-host"}, 8,
      {"shapes:world.listen='udp://127.0.0.1:5001'", "arm-host:arm.protocol='thimble'"});
  ASSERT_NE(shapes, nullptr);
  EXPECT_TRUE(shapes->findings().is_met());
  EXPECT_GT(shapes->session().arm(1).session().snapshot().total_contacts, 0U);
}

// Two hosts, joined by a cable instead of a network.
std::vector<std::string> along_a_line(const std::string& guest, const std::string& host,
                                      const std::string& rate,
                                      const std::vector<std::string>& more = {}) {
  std::vector<std::string> said{guest + ":arm.link='serial:/dev/ttyS0@" + rate + "'", host};
  said.insert(said.end(), more.begin(), more.end());
  return said;
}
std::string listens_at(const std::string& key, const std::string& rate) {
  return key + ".listen='serial:/dev/ttyS0@" + rate + "'";
}

TEST(SessionRun, AnArmFeelsAWorldAlongASerialLineByBothProtocols) {
  for (const char* protocol : {"thesis", "thimble"}) {
    SCOPED_TRACE(protocol);
    const auto run =
        played_examples({"world-host", "arm-host"}, 8,
                        along_a_line("arm-host", listens_at("world-host:world", "115200"), "115200",
                                     {std::string("arm-host:arm.protocol='") + protocol + "'"}));
    ASSERT_NE(run, nullptr);
    const Findings findings = run->findings();
    EXPECT_TRUE(findings.is_met());
    EXPECT_TRUE(findings.remarks.empty()) << findings.remarks[0];
    EXPECT_GT(run->session().arm(0).session().snapshot().total_contacts, 0U);
    const link::LinkStatus link = run->session().arm(0).link_status();
    EXPECT_TRUE(link.is_up);
    EXPECT_EQ(link.peer, "serial:/dev/ttyS0@115200");
    EXPECT_EQ(link.counters.receive_errors, 0U);
  }
}

// A frame of ours each way is some 35 and 32 ms at 38,400 bit/s, of 1999 5 and 5.
TEST(SessionRun, ASlowerLineTakesItsTime) {
  const auto round_trip = [](const char* rate) {
    const auto run = played_examples({"world-host", "arm-host"}, 4,
                                     along_a_line("arm-host", listens_at("world-host:world", rate),
                                                  rate, {"arm-host:arm.protocol='thimble'"}));
    return run ? seconds(run->session().arm(0).link_status().round_trip) : 0;
  };
  const double slow_s = round_trip("38400");
  const double fast_s = round_trip("3000000");
  EXPECT_GT(slow_s, 0.05);
  EXPECT_LT(slow_s, 0.2);
  EXPECT_GT(fast_s, 0.0005);
  EXPECT_LT(fast_s, 0.004);
}

TEST(SessionRun, TwoArmsAreCoupledAlongASerialLineAndGiveTheSameTraceAgain) {
  const auto hashes = [](const std::string& rate) {
    const auto run = played_examples(
        kTeleoperation, 4,
        along_a_line("teleoperation-guest", listens_at("teleoperation-host:arm", rate), rate));
    if (!run) return std::vector<std::uint64_t>{};
    EXPECT_TRUE(run->findings().is_met());
    EXPECT_TRUE(run->session().arm(1).link_status().is_up);
    return std::vector{run->trace(0).hash.value(), run->trace(1).hash.value()};
  };
  const auto first = hashes("115200");
  EXPECT_EQ(hashes("115200"), first);
  EXPECT_NE(hashes("460800"), first);
}

TEST(SessionRun, TwoRatesAtOneLineAreToldByWhoHearsGarbage) {
  for (const char* rate : {"38400", "57600", "3000000"}) {
    const auto run =
        played_examples({"world-host", "arm-host"}, 10,
                        along_a_line("arm-host", listens_at("world-host:world", rate), "115200"));
    ASSERT_NE(run, nullptr);
    EXPECT_EQ(run->session().arm(0).session().snapshot().total_contacts, 0U);
    const std::vector<std::string> remarks = run->findings().remarks;
    ASSERT_EQ(remarks.size(), 2U) << rate;
    const std::string gibberish =
        "world-host: world 'box': listen: nothing but damaged frames: does the other end run at " +
        std::string(rate) + " bit/s?; receive errors: ";
    EXPECT_EQ(remarks[0].substr(0, gibberish.size()), gibberish);
    EXPECT_EQ(remarks[1], "arm-host: arm 'right': link: nobody answers");
  }
}

// As of the hands and of the arms' networks: a mean over seeds is one over all that is random.
TEST(SessionRun, TheSeedIsThatOfAListenersNetworkToo) {
  const auto played_with = [](const std::string& seed_of_file, std::optional<std::uint64_t> seed) {
    auto run = SessionRun::load({.files = {THIMBLE_SOURCE_DIR "/examples/world-host.toml",
                                           THIMBLE_SOURCE_DIR "/examples/arm-host.toml"},
                                 .overrides = {"world-host:world.impairment.loss=0.3",
                                               "world-host:world.impairment.seed=" + seed_of_file},
                                 .seed = seed,
                                 .for_s = 4});
    if (run) (*run)->play();
    return run;
  };
  const auto hash = [&](const std::string& seed_of_file, std::optional<std::uint64_t> seed) {
    const auto run = played_with(seed_of_file, seed);
    return run ? (*run)->trace(0).hash.value() : 0;
  };
  EXPECT_NE(hash("11", {}), hash("12", {})) << "it matters which messages are lost";
  EXPECT_EQ(hash("11", 7), hash("12", 7)) << "instead of that of the file";

  const auto run = played_with("11", 7);
  ASSERT_TRUE(run);
  const Findings findings = (*run)->findings();
  const auto said = std::find_if(
      findings.parameters.begin(), findings.parameters.end(),
      [](const auto& parameter) { return parameter.name == "network_seed of world-host: box"; });
  ASSERT_NE(said, findings.parameters.end());
  EXPECT_EQ(said->value, Cell(8.0)) << "behind that of the arm";
}

TEST(SessionRun, WhoIsMeantByAChangeHasToBeThere) {
  const auto load = [](std::vector<std::string> files, std::vector<std::string> overrides) {
    const auto run = SessionRun::load(
        {.files = std::move(files), .overrides = std::move(overrides), .seed = {}});
    return run ? std::string() : run.error().message;
  };
  const std::string hello = THIMBLE_SOURCE_DIR "/tests/data/hello.toml";
  EXPECT_NE(load({hello}, {"helo:arm.hand.seed=2"}).find("no configuration is called 'helo'"),
            std::string::npos);
  EXPECT_EQ(load({hello}, {"hello:arm.hand.seed=2"}), "");
  EXPECT_NE(load({hello, hello}, {}).find("two configurations are called 'hello'"),
            std::string::npos);
  EXPECT_NE(load({}, {}), "");
}

}  // namespace
}  // namespace thimble::lab
