#include "cli/render.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "tests/unit/cli/sample_status.hpp"

namespace thimble::cli {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> out;
  std::size_t begin = 0;
  for (std::size_t end = text.find('\n'); end != std::string::npos;
       begin = end + 1, end = text.find('\n', begin)) {
    out.push_back(text.substr(begin, end - begin));
  }
  EXPECT_EQ(begin, text.size()) << "the last line has no end";
  return out;
}

// A status whose every text and number is as bad as a document can make it.
api::Status hostile_status() {
  const std::string text = std::string(500, 'x') + "\x1b[2J\n\xff";
  const double huge = std::numeric_limits<double>::max();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::uint64_t many = std::numeric_limits<std::uint64_t>::max();
  api::Status out;
  out.version = text;
  out.uptime_s = huge;
  out.degraded = {text, ""};
  out.safety = {text, text, text, text, true, true, true, 4'000'000'000};
  api::ArmStatus arm;
  arm.name = arm.device = arm.state = arm.lease = arm.world = arm.instruction = text;
  arm.calibration = arm.constraint_state = text;
  arm.position_m = {huge, -huge, nan};
  arm.force_newton = {huge, huge, huge};
  arm.offset_m = {-huge, nan, nan};
  arm.gimbal_rad = {huge, -huge, nan};
  arm.felt.pressure_newton = {huge, nan, -huge};
  arm.peak_force_newton = huge;
  arm.contacts = many;
  arm.faults = {{text, text, nan, text}};
  out.arms = {arm};
  out.servos = {{text, huge, many, many, {huge, nan, huge}, {}, {nan, nan, nan}, true}};
  out.links = {{text, "", text, text, true, huge, many, many, many, many, many},
               {"", text, text, text, false, nan, 0, 0, 0, 0, 0, nan, text + text}};
  out.worlds = {{text, "box:" + text, {4294967295U, 0, 1}, huge, 4294967295U}};
  return out;
}

void expect_fits(const std::string& text) {
  for (const std::string& line : lines_of(text)) {
    EXPECT_LE(columns_of(line), kColumns) << line;
    for (const char c : line) EXPECT_TRUE(static_cast<unsigned char>(c) >= 0x20) << line;
  }
}

TEST(Render, KeepsWithinEightyColumnsWhateverItIsTold) {
  for (const api::Status& status : {sample_status(), hostile_status(), api::Status{}}) {
    for (const Glyphs glyphs : {Glyphs::Ascii, Glyphs::Unicode}) {
      expect_fits(render_status(status, glyphs));
      expect_fits(render_report(status, glyphs));
      for (const std::size_t rows : {0U, 1U, 10U, 24U, 25U, 60U}) {
        expect_fits(render_watch(status, glyphs, rows));
      }
    }
  }
}

TEST(Render, CutsNothingOff) {
  api::Status status = sample_status();
  status.arms[0].name = "the-right-one-of-two";
  status.arms[0].device = "serial:A-very-long-number-of-a-controller:1.2";
  status.arms[0].offset_m = {-0.124, -0.124, 0.1};
  status.arms[0].peak_offset_m = 0.1755;
  status.worlds[0].source = "/home/somebody/volumes/a-scan-of-a-tooth.nhdr";
  status.worlds[0].pieces = {3, true, {}};
  for (const Glyphs glyphs : {Glyphs::Ascii, Glyphs::Unicode}) {
    const std::string text = render_status(status, glyphs);
    expect_fits(text);
    for (const char* end : {"held by configuration", "peak 175.5", "fingers 1", "holds piece 3",
                            "free motion", "[###......"}) {
      if (glyphs == Glyphs::Unicode && end[0] == '[') continue;
      // A line may end between two words.
      std::string joined = text;
      for (std::size_t at = 0; (at = joined.find("\n             ", at)) != std::string::npos;) {
        joined.replace(at, 14, " ");
      }
      EXPECT_THAT(joined, HasSubstr(end));
    }
  }
}

TEST(Render, UsesPlainCharactersWhereTheTerminalHasNoOthers) {
  for (const char c : render_watch(sample_status(), Glyphs::Ascii, 60)) EXPECT_GE(c, 0);
}

TEST(Render, SaysHowTheSafetyLinesStandWhereThereAreAny) {
  api::Status status = sample_status();
  EXPECT_THAT(render_status(status, {}), Not(HasSubstr("safety")));
  status.safety = {"bench", "stopped", "open", "it is pressed", false, false, false, 3};
  EXPECT_THAT(render_status(status, {}),
              AllOf(HasSubstr("safety bench  STOPPED  deadman OPEN  enable rests  stops 3"),
                    HasSubstr("it is pressed")));
  status.safety->must_release_deadman = true;
  EXPECT_THAT(render_status(status, {}), HasSubstr("deadman LET GO FIRST  enable"));
  status.safety->must_release_deadman = false;
  status.safety->is_deadman_held = true;
  EXPECT_THAT(render_status(status, {}), HasSubstr("deadman held  enable"));
}

TEST(Render, ShowsAGimbalInDegreesWhereThereIsOne) {
  api::Status status = sample_status();
  EXPECT_THAT(render_status(status, Glyphs::Ascii), Not(HasSubstr("gimbal")));
  status.arms[0].gimbal_rad = {0.5235988, -1.5707963, 0};
  for (const std::string& text :
       {render_status(status, Glyphs::Ascii), render_watch(status, Glyphs::Ascii, 40)}) {
    EXPECT_THAT(text, HasSubstr("  gimbal       +30.0  -90.0   +0.0 degrees\n"));
  }
}

TEST(Render, ShowsWhatCellsPressBackWithWhereTheWorldCountsThem) {
  api::Status status = sample_status();
  EXPECT_THAT(render_status(status, Glyphs::Ascii), Not(HasSubstr("pressure")));
  status.arms[0].felt.pressure_newton = {-0.5, 0, 1.2};
  for (const std::string& text :
       {render_status(status, Glyphs::Ascii), render_watch(status, Glyphs::Ascii, 40)}) {
    EXPECT_THAT(text, HasSubstr("  pressure     -0.50  +0.00  +1.20 N    1.30  of cells, as the "
                                "world has it\n"));
  }
  EXPECT_THAT(render_line(status), HasSubstr(" touching pressure 1.30 N\n"));
}

TEST(RenderWatch, ShowsWhatTheHandFeels) {
  EXPECT_THAT(
      render_watch(sample_status(), Glyphs::Ascii, 24),
      AllOf(HasSubstr("arm right  ACTIVE  sim:phantom-vintage  calibration done"),
            HasSubstr("+14.8   -3.5   +1.0 mm"), HasSubstr("-1.25  +0.50  +0.25 N"),
            HasSubstr("1.37"), HasSubstr("[###......"), HasSubstr("peak 3.25"),
            HasSubstr("+0.0 mm peak 4.2"), HasSubstr("TOUCHING   42 so far   constraints fresh"),
            HasSubstr("1000 Hz best-effort  ticks 83500  overruns 2"),
            HasSubstr("p50 10.0 us  p99 80.0 us  max 900.0 us"),
            HasSubstr("in-process up  round trip 1.00 ms"), HasSubstr("faults     none")));
}

TEST(RenderWatch, ShowsNoRateOfAnArmThatHasNotComeYet) {
  api::Status status = sample_status();
  status.servos[0].rate_hz.reset();
  EXPECT_THAT(render_watch(status, Glyphs::Ascii, 24), HasSubstr("- Hz best-effort  ticks 83500"));
}

TEST(RenderWatch, NeverFillsTheLastLineOfTheTerminal) {
  for (std::size_t rows = 2; rows < 50; ++rows) {
    EXPECT_LT(lines_of(render_watch(sample_status(), Glyphs::Ascii, rows)).size(), rows);
  }
}

TEST(RenderWatch, DrawsTheFingerAtTheRightWallOfTheBoxOnAClassicTerminal) {
  const std::string sut = render_watch(sample_status(), Glyphs::Ascii, 24);
  std::string row;
  for (const std::string& line : lines_of(sut)) {
    if (line.find("    |") == 0 && line.find('@') != std::string::npos) row = line;
  }
  ASSERT_FALSE(row.empty()) << sut;
  // Hollow to the left of the finger, wall to its right.
  EXPECT_EQ(row[row.find('@') - 1], ' ') << sut;
  EXPECT_EQ(row[row.find('@') + 1], ':') << sut;
}

// The picture's rows, each of both views.
std::vector<std::string> picture(const api::Status& status) {
  std::vector<std::string> out;
  for (const std::string& line : lines_of(render_watch(status, Glyphs::Ascii, 40))) {
    if (line.starts_with("    |")) out.push_back(line);
  }
  return out;
}

api::Status beside_a_sphere(const api::SphereStatus& sphere) {
  api::Status status = sample_status();
  status.worlds = {{"box", "sphere", {}, 0, 1}};
  status.worlds[0].sphere = sphere;
  status.arms[0].position_m = {-0.04, 0.04, 0.04};  // out of the way
  status.arms[0].felt.position_m = status.arms[0].position_m;
  return status;
}

TEST(RenderWatch, DrawsTheBallAndTheFloorOfASphere) {
  const api::Status status = beside_a_sphere({{0, 0, 0}, 0.02, -0.033});
  const std::vector<std::string> sut = picture(status);
  ASSERT_EQ(sut.size(), 15U);
  // A row is 6 mm high, a column 2.9 mm wide: 31 columns, the 16th in the middle.
  EXPECT_EQ(sut[7].substr(5, 31), "         :::::::::::::         ");
  EXPECT_EQ(sut[10].substr(5, 31), "            :::::::            ");
  EXPECT_EQ(sut[11].substr(5, 31), std::string(31, ' ')) << "between the ball and the floor";
  EXPECT_EQ(sut[12].substr(5, 31), std::string(31, ' '));
  EXPECT_EQ(sut[13].substr(5, 31), std::string(31, ':'));
  EXPECT_EQ(sut[14].substr(5, 31), std::string(31, ':'));
  EXPECT_EQ(sut[14].substr(42, 31), std::string(31, ' ')) << "no floor as high as the cut";
  EXPECT_EQ(sut[7].substr(42, 31), sut[7].substr(5, 31));
  EXPECT_THAT(render_watch(status, Glyphs::Ascii, 40), Not(HasSubstr("not drawn")));
}

TEST(RenderWatch, ABallFarOutIsStillInThePicture) {
  for (const double far_m : {0.2, -0.9}) {
    const auto sut = picture(beside_a_sphere({{far_m, 0, 0}, 0.05, -5}));
    const std::string all = std::accumulate(sut.begin(), sut.end(), std::string());
    EXPECT_NE(all.find(':'), std::string::npos) << far_m;
  }
}

TEST(RenderWatch, SaysWhatOfTheWorldIsNotDrawn) {
  const auto watched = [](const api::Status& status) {
    return render_watch(status, Glyphs::Ascii, 40);
  };
  api::Status status = sample_status();
  EXPECT_THAT(watched(status), Not(HasSubstr("drawn")));
  status.worlds[0].edits_applied = 1;
  EXPECT_THAT(watched(status), HasSubstr("drawn as configured, without the edits"));
  status.worlds[0].source = "scan.nrrd";
  EXPECT_THAT(watched(status), HasSubstr("cells are not drawn: the status does not tell"));
  status.worlds.clear();
  EXPECT_THAT(watched(status), HasSubstr("not drawn: it is on another host"));
  EXPECT_THAT(watched(beside_a_sphere({{0, 0, 0}, 0.02, -5})), HasSubstr("floor is below"));
}

TEST(RenderWatch, SaysSoEvenWhereThereIsNoRoomForThePicture) {
  api::Status status = sample_status();
  status.worlds[0].source = "scan.nrrd";
  const std::size_t text = lines_of(render_status(status, Glyphs::Ascii)).size();
  EXPECT_THAT(render_watch(status, Glyphs::Ascii, text + 2), HasSubstr("cells are not drawn"));
  for (std::size_t rows = 2; rows < 50; ++rows) {
    EXPECT_LT(lines_of(render_watch(status, Glyphs::Ascii, rows)).size(), rows);
  }
}

TEST(RenderWatch, DrawsTheHandApartFromWhereItIsFelt) {
  api::Status status = sample_status();
  EXPECT_THAT(render_watch(status, Glyphs::Unicode, 40), AllOf(HasSubstr("●"), HasSubstr("│")));
  const auto plus_signs = [](const std::string& text) {
    return std::count(text.begin(), text.end(), '+');
  };
  const auto before = plus_signs(render_watch(status, Glyphs::Unicode, 40));
  status.arms[0].felt.position_m[0] -= 0.02;
  EXPECT_EQ(plus_signs(render_watch(status, Glyphs::Unicode, 40)),
            before + 2);  // in x/y and in x/z
}

TEST(RenderStatus, TellsThePersonWhatToDoAndWhatWentWrong) {
  api::Status status = sample_status();
  status.degraded = {"no right to real-time scheduling"};
  status.arms[0].state = "fault";
  status.arms[0].instruction = "hold the arm in its rest";
  status.arms[0].faults = {{"overspeed", "the tip was too fast", 12.5, "/f/1.csv", 3}};
  EXPECT_THAT(render_status(status, Glyphs::Ascii),
              AllOf(HasSubstr("DEGRADED   no right"), HasSubstr("PLEASE     hold the arm"),
                    HasSubstr("FAULT      3 overspeed at 12.5 s: the tip"),
                    HasSubstr("recording /f/1.csv")));
}

TEST(RenderWatch, LeavesRoomForThePictureWhereMuchIsDegraded) {
  api::Status status = sample_status();
  const auto lines = [](const std::string& text) {
    return std::count(text.begin(), text.end(), '\n');
  };
  const auto before = lines(render_status(status, Glyphs::Ascii));
  status.degraded.assign(6, "memory lock refused: put LimitMEMLOCK=infinity into the unit");
  EXPECT_EQ(lines(render_status(status, Glyphs::Ascii)), before + 6) << "all of it";
  const std::string sut = render_watch(status, Glyphs::Ascii, 200);
  EXPECT_THAT(sut, HasSubstr("thimble status tells the rest"));
  const std::string kWord = "memory lock refused";
  std::size_t told = 0;
  for (std::size_t at = sut.find(kWord); at != std::string::npos; at = sut.find(kWord, at + 1)) {
    ++told;
  }
  EXPECT_EQ(told, 2U);
  status.degraded.resize(2);
  EXPECT_THAT(render_watch(status, Glyphs::Ascii, 200), Not(HasSubstr("tells the rest")));
}

TEST(RenderStatus, TellsWhyALinkIsDownAndNoRoundTripOfIt) {
  api::Status status = sample_status();
  status.links[0].last_error = "the world has no free cell";
  EXPECT_THAT(render_status(status, Glyphs::Ascii), Not(HasSubstr("no free cell")));
  status.links[0].is_up = false;
  status.links[0].kind = "udp";
  const std::string sut = render_status(status, Glyphs::Ascii);
  EXPECT_THAT(sut, AllOf(HasSubstr("DOWN  round trip -"),
                         HasSubstr("last trouble: the world has no free cell")));
  status.links[0].kind = "in-process";
  EXPECT_THAT(render_status(status, Glyphs::Ascii),
              AllOf(HasSubstr("in-process idle  round trip -"), Not(HasSubstr("DOWN"))));
}

TEST(RenderStatus, AsksWhatMayBeWrongWithAPeerThatDoesNotAnswer) {
  const std::string hint = "no answer: does the other daemon run, at that address";
  api::Status status = sample_status();
  api::LinkStatus& link = status.links[0];
  link.kind = "thimble";
  link.last_error.clear();
  EXPECT_THAT(render_status(status, Glyphs::Ascii), Not(HasSubstr(hint)));
  link.is_up = false;
  EXPECT_THAT(render_status(status, Glyphs::Ascii), HasSubstr(hint));
  link.last_error = "the network is unreachable";
  EXPECT_THAT(render_status(status, Glyphs::Ascii), Not(HasSubstr(hint)));
  link.last_error.clear();
  link.sent = 0;  // nothing was asked yet
  EXPECT_THAT(render_status(status, Glyphs::Ascii), Not(HasSubstr(hint)));
  link.sent = 7;
  link.arm.clear();
  EXPECT_THAT(render_status(status, Glyphs::Ascii), Not(HasSubstr(hint))) << "a world waits";
}

TEST(RenderStatus, NamesTheSchemeOfALinkAndWhyWhereItWasChosen) {
  api::Status status = sample_status();
  status.links[0].scheme.clear();
  EXPECT_THAT(render_status(status, Glyphs::Ascii), Not(HasSubstr("scheme")));
  status.links[0].scheme = "wave";
  EXPECT_THAT(render_status(status, Glyphs::Ascii), HasSubstr("scheme wave\n"));
  status.links[0].scheme_reason = "the world goes with it";
  EXPECT_THAT(render_status(status, Glyphs::Ascii),
              HasSubstr("scheme wave: the world goes with it\n"));
}

TEST(RenderLine, IsOneLineForEachArm) {
  api::Status status = sample_status();
  EXPECT_EQ(render_line(status),
            "83.5 s right active +14.8 -3.5 +1.0 mm 1.37 N offset 0.0 mm contacts 42 touching\n");
  status.arms.clear();
  EXPECT_EQ(render_line(status), "");
}

TEST(RenderLine, IsNotCutAtTheWidthOfATerminal) {
  api::Status status = sample_status();
  status.arms[0].name = std::string(kColumns, 'n');
  status.arms[0].faults = {{"estop", "the stop is pressed", 0, ""}};
  EXPECT_THAT(render_line(status), HasSubstr(" touching FAULT estop\n"));
}

TEST(RenderReport, SumsUpContactsForceOffsetAndTicks) {
  EXPECT_THAT(render_report(sample_status(), Glyphs::Ascii),
              AllOf(HasSubstr("session of 83.5 s"), HasSubstr("contacts   42"),
                    HasSubstr("peak force 3.25 N"),
                    HasSubstr("offset     peak 4.20 mm, at the end 0.00 mm"),
                    HasSubstr("ticks 83500"), Not(HasSubstr("position"))));
}

}  // namespace
}  // namespace thimble::cli
