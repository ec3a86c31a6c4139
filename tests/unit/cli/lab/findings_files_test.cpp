#include "cli/lab/findings_files.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <boost/json.hpp>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include "cli/file_text.hpp"
#include "tests/support/temporary_folder.hpp"

namespace thimble::lab_commands {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

lab::Findings sample() {
  return {.experiment = "probe",
          .title = "What a probe found",
          .parameters = {{"seed", "", 7.0}, {"speed", "m/s", 0.2}},
          .tables = {{.name = "offsets",
                      .title = "Offsets",
                      .columns = {{"reading", ""}, {"mean", "mm", 1}},
                      .rows = {{"a, \"b\"", 0.1}, {"none", kNone}}}},
          .plots = {{.name = "curve",
                     .title = "It's a curve",
                     .x = {"delay [ms]", true},
                     .y = {"offset [mm]", false},
                     .series = {{"one", lab::Mark::Points, {{1, 2}, {3, kNone}, {5, 6}}}}}},
          .criteria = {{"holds", true}, {"does not hold", false}},
          .remarks = {"Of note."}};
}

TEST(FindingsFiles, ACommaSeparatedTableQuotesWordsAndKeepsAllDigits) {
  EXPECT_EQ(to_csv(sample().tables[0]), "reading,mean [mm]\n\"a, \"\"b\"\"\",0.1\nnone,\n");
  const lab::Table third{.name = "t", .title = "", .columns = {{"x", ""}}, .rows = {{1.0 / 3}}};
  EXPECT_EQ(to_csv(third), "x\n0.3333333333333333\n");
}

TEST(FindingsFiles, TheDocumentHasEveryParameterWithItsUnitAndEveryVerdict) {
  const auto document = boost::json::parse(to_json(sample()));
  EXPECT_EQ(document.at("experiment"), "probe");
  EXPECT_EQ(document.at("parameters").at("speed").at("unit"), "m/s");
  EXPECT_EQ(document.at("parameters").at("seed").at("value"), 7.0);
  const auto& table = document.at("tables").at("offsets");
  EXPECT_EQ(table.at("columns").at(1).at("unit"), "mm");
  EXPECT_EQ(table.at("rows").at(0).at(1), 0.1);
  EXPECT_TRUE(table.at("rows").at(1).at(1).is_null());
  EXPECT_EQ(document.at("criteria").at(1).at("is_met"), false);
}

TEST(FindingsFiles, AScriptNamesItsAxesAndQuotesWhatPeopleWrote) {
  const std::string script = to_gnuplot(sample().plots[0], "probe-curve");
  EXPECT_NE(script.find("set title 'It''s a curve'"), std::string::npos) << script;
  EXPECT_NE(script.find("set xlabel 'delay [ms]'\nset logscale x\n"), std::string::npos);
  EXPECT_NE(script.find("set ylabel 'offset [mm]'\n"), std::string::npos);
  EXPECT_NE(script.find("1 2\n\n5 6\n"), std::string::npos) << "a gap where there is no number";
  EXPECT_NE(script.find("'probe-curve.svg'"), std::string::npos);
  EXPECT_NE(script.find("'probe-curve.png'"), std::string::npos);
}

TEST(FindingsFiles, SeriesOfOneStyleLookAlikeAndOneWithoutALabelIsNotInTheKey) {
  lab::Plot plot = sample().plots[0];
  plot.series = {{"measured", lab::Mark::Points, {{1, 2}}, 3},
                 {"", lab::Mark::Dashed, {{1, 2}}, 3},
                 {"other", lab::Mark::Line, {{1, 2}}}};
  const std::string script = to_gnuplot(plot, "probe-curve");
  EXPECT_NE(script.find("$series0 using 1:2 with points pt 9 ps 1.2 lw 1.5 lc rgb '#009e73' title "
                        "'measured', $series1 using 1:2 with lines lw 1.5 dt 2 lc rgb '#009e73' "
                        "notitle, $series2 using 1:2 with lines lw 1.8 lc rgb '#009e73' title "
                        "'other'"),
            std::string::npos)
      << script;
}

TEST(FindingsFiles, WritesIntoAFolderThatItMakes) {
  const std::string folder = testing::TempDir() + "findings/deep";
  std::filesystem::remove_all(folder);
  const auto written = write_findings(sample(), folder);
  ASSERT_TRUE(written) << written.error().message;
  for (const char* name : {"probe.json", "probe-offsets.csv", "probe-curve.gp"}) {
    EXPECT_TRUE(std::filesystem::is_regular_file(folder + '/' + name)) << name;
  }
  // With gnuplot or without, it says what it did.
  EXPECT_EQ(written->not_drawn.empty(), std::filesystem::exists(folder + "/probe-curve.svg"));
  EXPECT_EQ(written->files.size(), written->not_drawn.empty() ? 5U : 3U);
}

// In place of gnuplot: a program that draws as `cases` of sh say of its script $1, then exits well.
class AnotherGnuplot {
 public:
  explicit AnotherGnuplot(const std::string& cases) {
    const std::string program =
        folder_.write("gnuplot", "#!/bin/sh\nname=${1%.gp}\ncase $1 in\n" + cases +
                                     "\nesac\necho x >$name.svg; echo x >$name.png\n");
    EXPECT_EQ(::chmod(program.c_str(), 0700), 0);
    const std::string path = folder_.path().string() + ":" + before_;
    EXPECT_EQ(::setenv("PATH", path.c_str(), 1), 0);
  }
  ~AnotherGnuplot() { ::setenv("PATH", before_.c_str(), 1); }
  AnotherGnuplot(const AnotherGnuplot&) = delete;
  AnotherGnuplot& operator=(const AnotherGnuplot&) = delete;

 private:
  testing_support::TemporaryFolder folder_;
  std::string before_{std::getenv("PATH")};
};

Written draw_plots(const std::vector<std::string>& names) {
  const testing_support::TemporaryFolder folder;
  lab::Findings findings = sample();
  const lab::Plot plot = findings.plots[0];
  findings.plots.clear();
  for (const std::string& name : names) {
    findings.plots.push_back(plot);
    findings.plots.back().name = name;
  }
  auto written = write_findings(findings, folder.path().string());
  EXPECT_TRUE(written);
  Written out = written.value_or(Written{});
  for (std::string& file : out.files) file.erase(0, file.rfind('/') + 1);
  return out;
}

TEST(FindingsFiles, APlotThatWasNotDrawnIsToldOfThoughALaterOneIs) {
  const AnotherGnuplot program("*bad*) exit 1 ;;");
  const Written sut = draw_plots({"bad", "good", "worse-bad"});
  EXPECT_EQ(sut.not_drawn, "gnuplot refuses probe-bad.gp; gnuplot refuses probe-worse-bad.gp");
  EXPECT_EQ(sut.files, (std::vector<std::string>{"probe.json", "probe-offsets.csv", "probe-bad.gp",
                                                 "probe-good.gp", "probe-good.svg",
                                                 "probe-good.png", "probe-worse-bad.gp"}));
}

TEST(FindingsFiles, OneReasonIsSaidOnce) {
  const AnotherGnuplot program("*) kill -9 $$ ;;");
  EXPECT_EQ(draw_plots({"one", "two"}).not_drawn, "gnuplot was ended");
}

TEST(FindingsFiles, APictureIsWrittenOnlyIfItIsThereAndNotEmpty) {
  const AnotherGnuplot program(
      "*none*) exit 0 ;; *empty*) : >$name.svg; echo x >$name.png; exit 0 ;;");
  const Written sut = draw_plots({"empty", "none"});
  EXPECT_EQ(sut.not_drawn,
            "gnuplot did not draw probe-empty.svg; gnuplot did not draw probe-none.svg");
  EXPECT_EQ(sut.files,
            (std::vector<std::string>{"probe.json", "probe-offsets.csv", "probe-empty.gp",
                                      "probe-empty.png", "probe-none.gp"}));
}

TEST(FindingsFiles, SaysWhereItCannotWrite) {
  const auto written = write_findings(sample(), "/proc/none");
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().message.find("/proc/none"), std::string::npos);
}

TEST(FindingsFiles, AFolderIsMadeOrRefusedBeforeThereIsAnythingToWrite) {
  const testing_support::TemporaryFolder folder;
  const std::string deep = (folder / "a/b").string();
  EXPECT_TRUE(make_folder(deep));
  EXPECT_TRUE(make_folder(deep)) << "it may be there already";
  EXPECT_TRUE(std::filesystem::is_directory(deep));
  const std::string file = folder.write("file", "kept");
  EXPECT_EQ(make_folder(file).error(),
            (Error{Errc::InvalidArgument, file + ": is there, and is no folder"}));
  EXPECT_EQ(make_folder(file + "/under").error().code, Errc::System);
  EXPECT_EQ(make_folder("/proc/none").error().code, Errc::System);
  EXPECT_FALSE(make_folder(""));
}

TEST(FindingsFiles, PeopleAreToldTablesRemarksAndVerdicts) {
  EXPECT_EQ(
      lab::tell(sample()),
      "What a probe found\n\nOffsets\nreading  mean [mm]\na, \"b\"         0.1\nnone           "
      "  -\n\nOf note.\nas it must be: holds\nNOT as it must be: does not hold\n");
}

}  // namespace
}  // namespace thimble::lab_commands
