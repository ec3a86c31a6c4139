#include "cli/mistyped.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace thimble::cli {
namespace {

// The words as they stand on a command line behind the program's name.
std::string told_of(std::vector<std::string> words) {
  CLI::App app;
  app.require_subcommand(1);
  app.fallthrough();
  std::string socket;
  app.add_option("--socket", socket);
  app.add_subcommand("status")->add_flag("--json");
  app.add_subcommand("snapshot");
  CLI::App* lab = app.add_subcommand("lab");
  lab->require_subcommand(1);
  lab->add_subcommand("run");
  lab->add_subcommand("hello-sphere");
  std::reverse(words.begin(), words.end());  // as CLI11 wants them
  try {
    app.parse(words);
  } catch (const CLI::ParseError&) {
    return tell_mistyped(app);
  }
  return "well";
}

TEST(Mistyped, ASubcommandIsNamedWithTheOneThatWasMeant) {
  EXPECT_EQ(told_of({"stats"}), "there is no subcommand \"stats\"; did you mean status?");
  EXPECT_EQ(told_of({"--socket", "s", "stats", "--json"}),
            "there is no subcommand \"stats\"; did you mean status?");
  EXPECT_EQ(told_of({"lab", "hello-spere", "--seed", "3"}),
            "there is no subcommand \"hello-spere\"; did you mean hello-sphere?");
}

TEST(Mistyped, ASubcommandIsNotTakenForOneOfAnotherFolder) {
  EXPECT_EQ(told_of({"lab", "stats"}), "there is no subcommand \"stats\"");
  EXPECT_EQ(told_of({"hello-sphere"}), "there is no subcommand \"hello-sphere\"");
}

TEST(Mistyped, WhatIsLikeNothingIsOnlyNamedAndNeverSteersATerminal) {
  EXPECT_EQ(told_of({"zzzzzz"}), "there is no subcommand \"zzzzzz\"");
  EXPECT_EQ(told_of({"\x1b[31m"}), "there is no subcommand \"\\x1b[31m\"");
}

TEST(Mistyped, AnOptionBeforeItIsToldOfFirst) {
  EXPECT_EQ(told_of({"--sokcet", "s", "stats"}), "there is no option \"--sokcet\"");
}

TEST(Mistyped, NothingIsSaidWhereNoSubcommandIsMistyped) {
  EXPECT_EQ(told_of({}), "");
  EXPECT_EQ(told_of({"lab"}), "");
  EXPECT_EQ(told_of({"status"}), "well");
  EXPECT_EQ(told_of({"status", "more"}), "");
  EXPECT_EQ(told_of({"lab", "run"}), "well");
}

}  // namespace
}  // namespace thimble::cli
