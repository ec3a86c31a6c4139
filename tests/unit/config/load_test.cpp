#include "daemon/config/load.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/support/temporary_folder.hpp"
#include "tests/unit/config/config_testing.hpp"

namespace thimble::config {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

TEST(ConfigLoad, TakesTheSmallestConfigurationWithTheDefaultsOfTheDesign) {
  const auto sut = parse_text(kHello);
  ASSERT_TRUE(sut) << mistakes(kHello).front();
  EXPECT_EQ(sut->servo, ServoConfig{});
  EXPECT_EQ(sut->daemon, DaemonConfig{});
  ASSERT_THAT(sut->arms, SizeIs(1));
  EXPECT_EQ(sut->arms[0].limits, LimitsConfig{});
  EXPECT_EQ(sut->arms[0].coupling, CouplingConfig{});
  EXPECT_EQ(sut->arms[0].hand, HandConfig{});
  EXPECT_EQ(sut->arms[0].world, "box");
  EXPECT_TRUE(sut->arms[0].activate);
  ASSERT_THAT(sut->worlds, SizeIs(1));
  EXPECT_EQ(sut->worlds[0].source, "box:3");
  EXPECT_DOUBLE_EQ(sut->worlds[0].workspace_m, 0.09);
}

constexpr std::string_view kFull = R"(
[daemon]
socket = "/run/x.sock"
socket_mode = "0600"
group = "haptics"
flight_directory = "flights"
plugins = ["/lib/a.so", "/lib/b.so"]
[servo]
rate_hz = 2000
realtime = "required"
priority = 70
cpu = 1
[[arm]]
name = "right"
device = "sim:phantom-vintage"
model = "phantom-vintage"
amplifier_max_a = 3.0
firmware = "falcon.bin"
firmware_sha256 = "00ff00ff00ff00ff00ff00ff00ff00ff00ff00ff00ff00ff00ff00ff00ff00FF"
newton_per_count = 0.0025
link = "udp://[::1]:5001"
protocol = "thesis"
allow_unauthenticated = true
activate = false
[arm.hand]
motion = "explore"
seed = 7
speed_m_per_s = 0.2
reach_m = 0.04
stiffness_newton_per_m = 200
damping_newton_s_per_m = 4
mass_kg = 0.15
[arm.limits]
force_newton = 2
rise_newton_per_s = 500
ramp_s = 1
overspeed_m_per_s = 1.0
[arm.coupling]
scheme = "ghost-point"
mode = "lock-step"
stiffness_newton_per_m = 800
damping_newton_s_per_m = 10
coordinate_spring_newton_per_m = 50
hysteresis_m = 0.0005
relaxation_m_per_s = 0.025
freeze_after_s = 0.02
fade_after_s = 0.25
[arm.impairment]
delay_s = 0.1
jitter_s = 0.01
loss = 0.05
duplicate = 0.01
reorder = 0.02
seed = 3
[[world]]
name = "box"
source = "shapes/sphere.npy"
workspace_m = 0.1
threshold = 4
constraint_model = "simple"
listen = "udp://0.0.0.0:5001"
allow_unauthenticated = true
peer = "10.0.0.2"
[world.impairment]
loss = 1
)";

TEST(ConfigLoad, ReadsEveryKey) {
  const auto sut = parse_text(kFull);
  ASSERT_TRUE(sut) << mistakes(kFull).front();
  EXPECT_EQ(
      sut->daemon,
      (DaemonConfig{
          "/run/x.sock", 0600, "haptics", "/etc/thimble/flights", {"/lib/a.so", "/lib/b.so"}}));
  EXPECT_EQ(sut->servo, (ServoConfig{2000, Realtime::Required, 70, 1}));
  const ArmConfig arm{"right",
                      "sim:phantom-vintage",
                      "phantom-vintage",
                      3.0,
                      "/etc/thimble/falcon.bin",
                      "00ff00ff00ff00ff00ff00ff00ff00ff00ff00ff00ff00ff00ff00ff00ff00FF",
                      0.0025,
                      Fallback::None,
                      std::nullopt,
                      UdpEndpoint{"::1", 5001},
                      LinkProtocol::Thesis,
                      true,
                      false,
                      HandConfig{HandMotion::Explore, 7, 0.2, 0.04, 200, 4, 0.15},
                      LimitsConfig{2, 500, 1, 1},
                      CouplingConfig{CouplingScheme::GhostPoint, CouplingMode::LockStep, 800, 10,
                                     50, 0.0005, 0.025, 0.02, 0.25},
                      ImpairmentConfig{0.1, 0.01, 0.05, 0.01, 0.02, 3}};
  EXPECT_THAT(sut->arms, ElementsAre(arm));
  const WorldConfig world{"box",
                          "/etc/thimble/shapes/sphere.npy",
                          0.1,
                          4,
                          ConstraintModel::Simple,
                          UdpEndpoint{"0.0.0.0", 5001},
                          true,
                          "10.0.0.2",
                          ImpairmentConfig{0, 0, 1, 0, 0, 1}};
  EXPECT_THAT(sut->worlds, ElementsAre(world));
}

TEST(ConfigLoad, ReportsEveryMistakeAtOnceInTheOrderOfTheFile) {
  const std::string text =
      "[servo]\n"
      "rate_hz = 100\n"
      "prioritty = 3\n"
      "[[arm]]\n"
      "name = \"Right\"\n"
      "device = 7\n"
      "world = \"bx\"\n"
      "limits.ramp_s = 0.1\n"
      "[[world]]\n"
      "name = \"box\"\n"
      "source = \"box:2\"\n";
  EXPECT_THAT(
      mistakes(text),
      ElementsAre("/etc/thimble/t.toml:2:11: servo.rate_hz: expected a number from 500 to 8000, "
                  "found 100",
                  "/etc/thimble/t.toml:3:1: servo.prioritty: there is no such key; did you mean "
                  "\"priority\"?",
                  AllOf(HasSubstr("t.toml:5:8: arm.0.name:"), HasSubstr("found \"Right\"")),
                  "/etc/thimble/t.toml:6:10: arm.0.device: expected a string, found 7",
                  "/etc/thimble/t.toml:7:9: arm.0.world: expected the name of a [[world]] of this "
                  "configuration, found \"bx\"; did you mean \"box\"?",
                  AllOf(HasSubstr("t.toml:8:17: arm.0.limits.ramp_s:"), HasSubstr("0.5 to 60")),
                  AllOf(HasSubstr("t.toml:11:10: world.0.source:"), HasSubstr("3 to 1024"))));
}

// Which current is too large is the driver's to say: it knows the controller's wire.
TEST(ConfigLoad, LeavesTheLargestCurrentToTheDriver) {
  for (const double current_a : {0.5, 32.767, 50.5, 1e6}) {
    const std::string text =
        hello_with_arm("amplifier_max_a = " + std::to_string(current_a) + "\n");
    const auto sut = parse_text(text);
    ASSERT_TRUE(sut) << current_a;
    EXPECT_DOUBLE_EQ(sut->arms[0].amplifier_max_a.value_or(0), current_a);
  }
}

TEST(ConfigLoad, SaysWhereTheTableIsThatLacksAKey) {
  EXPECT_THAT(mistakes("[servo]\n\n[[arm]]\nactivate = true\n"),
              ElementsAre(HasSubstr("t.toml:3:1: arm.0.name: expected a name"),
                          HasSubstr("t.toml:3:1: arm.0.device: expected a device"),
                          HasSubstr("t.toml:3:1: arm.0: expected either world or link")));
}

TEST(ConfigLoad, RefusesAConfigurationWithoutArmAndWorld) {
  for (const char* text : {"", "[servo]\nrate_hz = 1000\n", "arm = []\nworld = []\n"}) {
    EXPECT_THAT(mistakes(text), ElementsAre(HasSubstr("at least one [[arm]] or [[world]]")));
  }
}

struct BadLine {
  const char* arm_lines;
  const char* world_lines;
  const char* expected;
};

class ConfigLoadBadLine : public testing::TestWithParam<BadLine> {};

TEST_P(ConfigLoadBadLine, IsTheOnlyMistakeReported) {
  std::string text = hello_with_arm(GetParam().arm_lines);
  text += GetParam().world_lines;
  EXPECT_THAT(mistakes(text), ElementsAre(HasSubstr(GetParam().expected))) << text;
}

INSTANTIATE_TEST_SUITE_P(
    Values, ConfigLoadBadLine,
    testing::Values(
        BadLine{"amplifier_max_a = nan\n", "", "found nan"},
        BadLine{"amplifier_max_a = inf\n", "", "found inf"},
        BadLine{"amplifier_max_a = -1\n", "", "a number above 0, found -1"},
        BadLine{"amplifier_max_a = \"3\"\n", "", "a number above 0, found \"3\""},
        BadLine{"activate = 1\n", "", "expected true or false, found 1"},
        BadLine{"model = \"\"\n", "", "not empty"},
        BadLine{"model = 1979-05-27\n", "", "found a date or time"},
        BadLine{"hand = 3\n", "", "arm.0.hand: expected a table, found 3"},
        BadLine{"hand.motion = \"jump\"\n", "", "\"tremor\", \"explore\", found \"jump\""},
        BadLine{"hand.seed = -1\n", "", "found -1"},
        BadLine{"hand.seed = 1.5\n", "", "a whole number"},
        BadLine{"hand.reach_m = 0.11\n", "", "0 to 0.1, found 0.11"},
        BadLine{"hand.speed_m_per_s = 0\n", "", "0.001 to 0.5, found 0"},
        BadLine{"hand.mass_kg = 6\n", "", "0.02 to 5, found 6"},
        BadLine{"hand.damping_newton_s_per_m = 101\n", "", "0 to 100, found 101"},
        BadLine{"limits.rise_newton_per_s = 1001\n", "", "up to 1000, found 1001"},
        BadLine{"limits.overspeed_m_per_s = 2\n", "", "up to 1.5, found 2"},
        BadLine{"limits.force_newton = 0\n", "", "above 0"},
        BadLine{"coupling.scheme = []\n", "", "found an array"},
        BadLine{"coupling.fade_after_s = 61\n", "", "up to 60"},
        BadLine{"impairment.loss = 1.01\n", "", "from 0 to 1"},
        BadLine{"impairment.delay_s = 2.1\n", "", "from 0 to 2"},
        BadLine{"protocol = \"thesis\"\n", "", "only beside link"},
        BadLine{"link = \"udp://127.0.0.1:5001\"\n", "", "found both"},
        BadLine{"allow_unauthenticated = true\n", "", "only beside link"},
        BadLine{"", "workspace_m = 0\n", "above 0"},
        BadLine{"", "threshold = 2e9\n", "from -1e+09 to 1e+09"},
        BadLine{"", "listen = \"udp://somewhere:5001\"\n", "numeric address"},
        BadLine{"", "listen = \"udp://0.0.0.0:5001\"\n", "expected a loopback address"},
        BadLine{"", "listen = \"udp://0.0.0.0:5001\"\npeer = \"10.0.0.2\"\n", "loopback"},
        BadLine{"", "listen = \"udp://127.0.0.1:5001\"\npeer = \"me\"\n", "numeric address"},
        BadLine{"", "peer = \"10.0.0.2\"\n", "only beside listen"},
        BadLine{"", "[daemon]\nsocket_mode = \"0666\"\n", "nothing for others"},
        BadLine{"", "[daemon]\nsocket_mode = \"rw\"\n", "octal"},
        BadLine{"", "[daemon]\nsocket = \"a\\u0000b\"\n", "without zero bytes"},
        BadLine{"", "[servo]\npriority = 90\n", "from 1 to 89"},
        BadLine{"", "[servo]\nrealtime = \"yes\"\n", "one of \"best-effort\", \"required\""},
        BadLine{"", "[[world]]\nname = \"box\"\nsource = \"box:4\"\n",
                "world.1.name: expected a name of its own"},
        BadLine{"", "[[world]]\nname = \"b\"\nsource = \"ball\"\n", "found \"ball\""},
        BadLine{"", "[servp]\n", "did you mean \"servo\"?"},
        BadLine{"", "[\"\\u001b[2J\"]\n", "\"\\x1b[2J\": there is no such key"}));

TEST(ConfigLoad, RefusesTheSameHardwareOrListenerTwiceButNotTheSameModel) {
  const std::string arms =
      "[[arm]]\nname = \"a\"\ndevice = \"hid:1\"\nworld = \"w\"\n"
      "[[arm]]\nname = \"b\"\ndevice = \"hid:1\"\nworld = \"w\"\n"
      "[[arm]]\nname = \"c\"\ndevice = \"sim:x\"\nworld = \"w\"\n"
      "[[arm]]\nname = \"d\"\ndevice = \"sim:x\"\nworld = \"w\"\n";
  const std::string worlds =
      "[[world]]\nname = \"w\"\nsource = \"box:3\"\nlisten = \"udp://127.0.0.1:1\"\n"
      "[[world]]\nname = \"v\"\nsource = \"box:3\"\nlisten = \"udp://127.0.0.1:1\"\n";
  EXPECT_THAT(mistakes(arms + worlds),
              ElementsAre(HasSubstr(":7:10: arm.1.device"), HasSubstr(":24:10: world.1.listen")));
}

TEST(ConfigLoad, TakesADeviceOnEachBusThatItKnows) {
  const std::string arm = "[[arm]]\nname = \"a\"\ndevice = \"";
  const std::string rest = "\"\nworld = \"w\"\n[[world]]\nname = \"w\"\nsource = \"box:3\"\n";
  for (const char* device : {"sim:x", "hid:1", "usb:1-4", "serial:1234567", "pci:0"})
    EXPECT_THAT(mistakes(arm + device + rest), ElementsAre()) << device;
  EXPECT_THAT(mistakes(arm + "serial:" + rest), ElementsAre(HasSubstr("serial:SERIAL")));
}

TEST(ConfigLoad, HintsAtTheDoubleBracketsOfArms) {
  EXPECT_THAT(mistakes("[arm]\nname = \"a\"\n"),
              ElementsAre(HasSubstr("[[arm]] or [[world]]"),
                          HasSubstr("expected tables, each under [[arm]], found a table")));
}

TEST(ConfigLoad, PointsAtASyntaxErrorByLine) {
  const auto sut = parse_text("[servo]\nrate_hz = = 3\n");
  ASSERT_FALSE(sut);
  ASSERT_THAT(sut.error(), SizeIs(1));
  EXPECT_EQ(sut.error()[0].line, 2);
  EXPECT_THAT(sut.error()[0].message, HasSubstr("expected TOML"));
}

TEST(ConfigLoad, RefusesWhatIsNotUtf8) {
  EXPECT_THAT(mistakes("# \xff\xfe\n"), ElementsAre(HasSubstr("UTF-8")));
  EXPECT_THAT(mistakes(std::string("\0\0\0", 3)), ElementsAre(HasSubstr("UTF-8")));
}

TEST(ConfigLoad, RefusesStrayLettersOfEveryLanguage) {
  for (const char* letter : {"¡", "ü", "ѐ", "中", "𝄞"}) {
    EXPECT_THAT(mistakes(std::string("a = 1") + letter + "\n"),
                ElementsAre(HasSubstr("t.toml:1:")));
  }
}

std::string dotted(std::size_t dots) {
  std::string out = "a";
  for (std::size_t i = 0; i < dots; ++i) out += ".a";
  return out;
}

TEST(ConfigLoad, SaysNothingToATerminalThatIsNotText) {
  const std::string odd = R"("\u001b[2J\u0007")";
  for (const std::string& text :
       {odd + " = 1\n", "[servo]\n" + odd + " = 1\n", "servo = " + odd + "\n",
        "[[arm]]\nname = " + odd + "\ndevice = " + odd + "\n", std::string("x = \x1b\n"),
        "[[arm]]\nname = \"a\"\nlink = " + odd + "\n"}) {
    for (const std::string& mistake : mistakes(text)) {
      EXPECT_TRUE(std::ranges::none_of(mistake, [](char c) { return c >= 0 && c < 0x20; }))
          << testing::PrintToString(mistake);
    }
  }
  const auto sut = load("no\x1bsuch\nfile");
  ASSERT_FALSE(sut);
  EXPECT_THAT(to_string(sut.error()[0]), HasSubstr("no\\x1bsuch\\x0afile"));
}

TEST(ConfigLoad, RefusesATableHeaderThatIsNoKey) {
  for (const char* header : {"[+]", "[[+]]", "[\x06", "[(", "[[\xC3\xA9]]", "[=]", "[.a]"}) {
    EXPECT_THAT(mistakes("\n" + std::string(header) + "\n"), ElementsAre(HasSubstr("t.toml:2:")))
        << header;
  }
}

TEST(ConfigLoad, RefusesKeysOfTooManyPartsAtTheirLine) {
  constexpr std::size_t kMostThatFit = kMaxFileBytes / 2 - 16;
  for (const std::size_t dots : {kMaxDotsInLine + 1, kMostThatFit}) {
    EXPECT_THAT(mistakes("# x\n" + dotted(dots) + " = 1\n"),
                ElementsAre(AllOf(HasSubstr("t.toml:2: "), HasSubstr("at most 256 dots"))));
    EXPECT_THAT(mistakes("\n\n[" + dotted(dots) + "]\n"),
                ElementsAre(HasSubstr("t.toml:3: expected at most 256 dots")));
    EXPECT_THAT(mistakes(kHello, {"servo.rate_hz={" + dotted(dots) + " = 1}"}),
                ElementsAre(HasSubstr("at most 256 dots")));
  }
  EXPECT_THAT(mistakes(dotted(kMaxDotsInLine) + " = 1\n"), testing::Each(Not(HasSubstr("dots"))));
}

TEST(ConfigLoad, RefusesToNestDeeperByLinesOfManyParts) {
  std::string text = "x = ";
  for (int i = 0; i < 100; ++i) text += "[\n{" + dotted(kMaxDotsInLine) + " = ";
  EXPECT_THAT(mistakes(text.substr(0, kMaxFileBytes)), ElementsAre(HasSubstr("exceeded maximum")));
}

TEST(ConfigLoad, BoundsTheNumberOfMessages) {
  std::string text(kHello);
  for (int i = 0; i < 300; ++i) text += "unknown-key-" + std::to_string(i) + " = 1\n";
  const auto sut = mistakes(text);
  EXPECT_THAT(sut, SizeIs(kMaxErrors + 1));
  EXPECT_THAT(sut.back(), HasSubstr("200 more mistakes"));
}

class ConfigFile : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path write(const std::string& name, std::string_view text) const {
    return home_.write(name, text);
  }
  static std::string first_mistake(const std::filesystem::path& file) {
    const auto result = load(file);
    return result ? "" : to_string(result.error().front());
  }

  testing_support::TemporaryFolder home_;
  const std::filesystem::path folder_ = home_.path();
};

TEST_F(ConfigFile, IsReadFromDisk) { EXPECT_TRUE(load(write("good.toml", kHello))); }

TEST_F(ConfigFile, ThatIsMissingOrADirectoryIsRefusedByName) {
  EXPECT_EQ(first_mistake(folder_ / "none.toml"),
            (folder_ / "none.toml").string() + ": cannot open: No such file or directory");
  EXPECT_EQ(first_mistake(folder_), folder_.string() + ": expected a file, found a directory");
}

TEST_F(ConfigFile, ThatIsAPipeOrADeviceIsRefusedWithoutWaitingForIt) {
  const auto pipe = folder_ / "pipe.toml";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(first_mistake(pipe),
            pipe.string() + ": expected a regular file, found a pipe or a device");
  EXPECT_THAT(first_mistake("/dev/zero"), HasSubstr("expected a regular file"));
}

TEST_F(ConfigFile, LargerThanTheLimitIsRefusedAndAtTheLimitIsNot) {
  std::string text(kHello);
  text += "# " + std::string(kMaxFileBytes - text.size() - 3, 'x') + "\n";
  ASSERT_EQ(text.size(), kMaxFileBytes);
  EXPECT_EQ(first_mistake(write("full.toml", text)), "");
  EXPECT_THAT(first_mistake(write("over.toml", text + "\n")), HasSubstr("at most 65536 bytes"));
}

}  // namespace
}  // namespace thimble::config
