#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/unit/config/config_testing.hpp"

namespace thimble::config {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

std::string pieces_with(const std::string& lines) {
  return "[[world]]\nname = \"w\"\nsource = \"pieces\"\n" + lines;
}

TEST(ConfigPieces, NeedNothingButTheirName) {
  const auto sut = parse_text(pieces_with(""));
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->worlds.at(0).source, "pieces");
  EXPECT_EQ(sut->worlds.at(0).pieces, PiecesConfig{});
  EXPECT_FALSE(sut->worlds.at(0).sphere);
}

TEST(ConfigPieces, ReadsEveryKey) {
  const auto sut = parse_text(
      pieces_with("workspace_m = 0.1\n[world.pieces]\ncells = 64\ncount = 63\nseed = 9\nsearch = "
                  "\"one-cell\"\nboards = 4\nboard = \"sim-usb\"\n"));
  ASSERT_TRUE(sut);
  const PiecesConfig expected{64, 63, 9, PieceSearch::OneCell, 4, PieceBoardKind::SimUsb};
  EXPECT_EQ(sut->worlds.at(0).pieces, expected);
  EXPECT_EQ(sut->worlds.at(0).workspace_m, 0.1);
}

TEST(ConfigPieces, TheHandIsFollowedByLeapsByTheTrailOrCellByCell) {
  const auto search_of = [](const std::string& line) {
    return parse_text(pieces_with(line)).value().worlds.at(0).pieces->search;
  };
  EXPECT_EQ(search_of(""), PieceSearch::Leap);
  EXPECT_EQ(search_of("pieces.search = \"leap\"\n"), PieceSearch::Leap);
  EXPECT_EQ(search_of("pieces.search = \"trail\"\n"), PieceSearch::Trail);
  EXPECT_EQ(search_of("pieces.search = \"one-cell\"\n"), PieceSearch::OneCell);
}

TEST(ConfigPieces, ARealBoardSaysItselfHowLargeItIs) {
  const auto usb = parse_text(pieces_with("pieces.board = \"usb\"\n"));
  ASSERT_TRUE(usb);
  EXPECT_EQ(usb->worlds.at(0).pieces->board, PieceBoardKind::Usb);
  const auto pci = parse_text(pieces_with("pieces.board = \"pci\"\n"));
  ASSERT_TRUE(pci);
  EXPECT_EQ(pci->worlds.at(0).pieces->board, PieceBoardKind::Pci);
}

TEST(ConfigPieces, InSpaceThereAreFewerCellsAlongAnAxis) {
  const auto sut = parse_text(pieces_with("pieces.axes = 3\n"));
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->worlds.at(0).pieces->axes, 3);
  EXPECT_EQ(sut->worlds.at(0).pieces->cells, 64);
  EXPECT_EQ(
      parse_text(pieces_with("pieces.axes = 3\npieces.cells = 32\n"))->worlds.at(0).pieces->cells,
      32);
}

TEST(ConfigPieces, ThereAreSevenAtMostWhenTheyAreDynamic) {
  const auto sut = parse_text(pieces_with("pieces.dynamic = true\n"));
  ASSERT_TRUE(sut);
  EXPECT_TRUE(sut->worlds.at(0).pieces->is_dynamic);
  EXPECT_EQ(sut->worlds.at(0).pieces->count, 7);
  EXPECT_EQ(parse_text(pieces_with("pieces.dynamic = true\npieces.count = 2\n"))
                ->worlds.at(0)
                .pieces->count,
            2);
  EXPECT_TRUE(parse_text(pieces_with("pieces.dynamic = false\npieces.count = 8\n")));
}

TEST(ConfigPieces, PressureIsOffUnlessItIsSaid) {
  EXPECT_EQ(parse_text(pieces_with(""))->worlds.at(0).pieces->pressure_newton_per_m, std::nullopt);
  EXPECT_EQ(parse_text(pieces_with("pieces.pressure_newton_per_m = 25\n"))
                ->worlds.at(0)
                .pieces->pressure_newton_per_m,
            25);
}

TEST(ConfigPieces, ABoardShowsItselfOnlyIfItIsSaid) {
  EXPECT_EQ(parse_text(pieces_with(""))->worlds.at(0).pieces->display_every, std::nullopt);
  EXPECT_EQ(
      parse_text(pieces_with("pieces.display_every = 7\n"))->worlds.at(0).pieces->display_every, 7);
}

TEST(ConfigPieces, ALayoutLiesBesideTheConfiguration) {
  const auto sut = parse_text(pieces_with("pieces.layout = \"parts/puzzle.npy\"\n"));
  ASSERT_TRUE(sut);
  EXPECT_THAT(*sut->worlds.at(0).pieces->layout, testing::EndsWith("parts/puzzle.npy"));
}

TEST(ConfigPieces, TheirTableBesideAnotherSourceIsAMistake) {
  EXPECT_THAT(mistakes("[[world]]\nname = \"w\"\nsource = \"box:3\"\n[world.pieces]\n"),
              ElementsAre(AllOf(HasSubstr("world.0.pieces"), HasSubstr("\"box:3\""))));
}

std::string on_boards(const std::string& first, const std::string& second) {
  const auto world = [](const std::string& name, const std::string& board) {
    return "[[world]]\nname = \"" + name + "\"\nsource = \"pieces\"\npieces.board = \"" + board +
           "\"\n";
  };
  return world("a", first) + world("b", second);
}

TEST(ConfigPieces, TheOneBoardInASlotIsOfOneWorld) {
  EXPECT_THAT(mistakes(on_boards("pci", "pci")),
              ElementsAre(AllOf(HasSubstr("world.1.pieces"), HasSubstr("found it of \"a\", too"))));
  for (const char* other : {"usb", "sim", "sim-usb"}) {
    EXPECT_TRUE(parse_text(on_boards("pci", other))) << other;
    EXPECT_TRUE(parse_text(on_boards(other, "pci"))) << other;
    EXPECT_TRUE(parse_text(on_boards(other, other))) << other << ": there may be as many";
  }
}

struct BadPieces {
  const char* lines;
  const char* expected;
};
class ConfigPiecesBadLine : public testing::TestWithParam<BadPieces> {};

TEST_P(ConfigPiecesBadLine, IsTheOnlyMistakeReported) {
  EXPECT_THAT(mistakes(pieces_with(GetParam().lines)), ElementsAre(HasSubstr(GetParam().expected)));
}

INSTANTIATE_TEST_SUITE_P(
    Values, ConfigPiecesBadLine,
    testing::Values(BadPieces{"pieces.cells = 96\n", "a power of two, found 96"},
                    BadPieces{"pieces.cells = 1024\n", "32 to 512"},
                    BadPieces{"pieces.boards = 3\n", "a power of two, found 3"},
                    BadPieces{"pieces.boards = 16\n", "1 to 8"},
                    BadPieces{"pieces.board = \"isa\"\n", "\"pci\""},
                    BadPieces{"pieces.board = \"pci\"\npieces.boards = 8\n", "simulated board"},
                    BadPieces{"pieces.board = \"usb\"\npieces.boards = 8\n", "simulated board"},
                    BadPieces{"pieces.count = 64\n", "1 to 63"},
                    BadPieces{"pieces.count = 0\n", "1 to 63"},
                    BadPieces{"pieces.dynamic = true\npieces.count = 8\n", "at most 7"},
                    BadPieces{"pieces.dynamic = true\npieces.count = 64\n", "1 to 63"},
                    BadPieces{"pieces.dynamic = 1\n", "pieces.dynamic"},
                    BadPieces{"pieces.pressure_newton_per_m = 0\n", "above 0"},
                    BadPieces{"pieces.pressure_newton_per_m = 2e5\n", "20000"},
                    BadPieces{"pieces.display_every = 0\n", "1 to 1000"},
                    BadPieces{"pieces.display_every = 7.5\n", "pieces.display_every"},
                    BadPieces{"pieces.seed = -1\n", "pieces.seed"},
                    BadPieces{"pieces.search = \"fast\"\n", "\"leap\""},
                    BadPieces{"pieces.axes = 1\n", "2 to 3"},
                    BadPieces{"pieces.axes = 3\npieces.cells = 128\n", "at most 64"},
                    BadPieces{"pieces.layout = \"puzzle.png\"\n", "puzzle.png"},
                    BadPieces{"pieces.layout = \"a.npy\"\npieces.seed = 2\n", "pieces.seed"},
                    BadPieces{"pieces = 3\n", "world.0.pieces: expected a table, found 3"},
                    BadPieces{"threshold = 1\n", "only with a volume file"}));

}  // namespace
}  // namespace thimble::config
