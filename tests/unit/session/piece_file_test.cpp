#include "daemon/session/piece_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "daemon/session/piece_settings.hpp"
#include "daemon/world/cam/piece_world.hpp"
#include "daemon/world/io/nrrd_write.hpp"
#include "sim/time/virtual_clock.hpp"
#include "tests/unit/world/npy_bytes.hpp"
#include "tests/unit/world/volume_files.hpp"

namespace thimble::session {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class PieceFiles : public world::VolumeFiles {
 protected:
  // Numbers of 8 bits, x first.
  std::string npy(const std::string& shape, const std::string& numbers) const {
    world::NpyBytes bytes;
    bytes.descr = "'|i1'";
    bytes.fortran_order = "True";
    bytes.shape = shape;
    bytes.data = numbers;
    return write("pieces.npy", bytes.file());
  }
  Error refusal_of(const std::string& path) const {
    const auto read = read_piece_file(path);
    EXPECT_FALSE(read);
    if (read) return {};
    EXPECT_THAT(read.error().message, StartsWith(path));
    return read.error();
  }
};

TEST_F(PieceFiles, EachNumberIsThatOfItsCellsPiece) {
  std::mt19937 random(5);
  std::string numbers(32 * 16 * 8, '\0');
  for (char& number : numbers) number = static_cast<char>(random() % 64);
  const auto read = read_piece_file(npy("(32, 16, 8)", numbers));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->log2_cells, (CamAxes{5, 4, 3}));
  ASSERT_EQ(read->layout.size(), numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    ASSERT_EQ(read->layout[i], static_cast<std::uint8_t>(numbers[i])) << i;
  }
}

TEST_F(PieceFiles, WhatWasWrittenIsReadBack) {
  const CamGeometry space{{6, 5, 4}, CamDivision::StripY};
  const auto layout = world::cam::random_layout(space, 6, 3).value();
  const auto read =
      read_piece_file(write("saved.nrrd", world::nrrd_of_bytes({64, 32, 16}, layout)));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->log2_cells, space.log2_cells);
  EXPECT_EQ(read->layout, layout);
}

TEST_F(PieceFiles, WhatIsBelowZeroIsNoPiece) {
  std::string numbers(32 * 32, '\0');
  numbers[7] = -3;
  numbers[8] = 63;
  const auto read = read_piece_file(npy("(32, 32, 1)", numbers));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->layout[7], 0);
  EXPECT_EQ(read->layout[8], 63);
}

TEST_F(PieceFiles, ANumberBeyondTheLastPieceIsRefused) {
  std::string numbers(32 * 32, '\0');
  numbers[100] = 64;
  numbers[101] = 65;
  EXPECT_THAT(refusal_of(npy("(32, 32, 1)", numbers)).message,
              HasSubstr("2 numbers are no piece's"));
}

TEST_F(PieceFiles, ASpaceThatNoBoardHasIsRefused) {
  EXPECT_THAT(refusal_of(npy("(24, 64, 1)", std::string(24 * 64, '\1'))).message,
              HasSubstr("24 cells along an axis are no power of two"));
  EXPECT_THAT(refusal_of(npy("(16, 16, 1)", std::string(256, '\0'))).message,
              HasSubstr("2^10 to 2^18 cells, this one 2^8"));
  EXPECT_EQ(refusal_of(folder + "/none.npy").code, Errc::NotFound);
}

TEST_F(PieceFiles, AreTheWorldOfAConfiguration) {
  const sim::VirtualClock clock;
  config::WorldConfig said;
  said.source = "pieces";
  said.pieces = config::PiecesConfig{};
  said.pieces->layout = npy("(64, 16, 2)", std::string(64 * 16 * 2, '\0'));
  const auto made = make_piece_world(said, &clock);
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_EQ(made->world->info().cells, (std::array<std::uint32_t, 3>{64, 16, 2}));
  EXPECT_EQ(made->world->pieces()->board().settings().search, world::cam::SearchKind::BoundedSweep)
      << "they may be thinner than a leap";
  said.pieces->layout = npy("(256, 8, 1)", std::string(256 * 8, '\0'));
  const auto narrow = make_piece_world(said, &clock);
  ASSERT_FALSE(narrow);
  EXPECT_THAT(narrow.error().message, HasSubstr("8 of them 16 along y"));
}

TEST_F(PieceFiles, OfDynamicPiecesHaveNumbersUpToSeven) {
  const sim::VirtualClock clock;
  config::WorldConfig said;
  said.source = "pieces";
  said.pieces = config::PiecesConfig{};
  said.pieces->is_dynamic = true;
  said.pieces->layout = npy("(64, 16, 2)", std::string(64 * 16 * 2, '\7'));
  const auto made = make_piece_world(said, &clock);
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_TRUE(made->world->pieces()->board().settings().is_dynamic);
  said.pieces->layout = npy("(64, 16, 2)", std::string(64 * 16 * 2 - 1, '\7') + '\10');
  const auto eighth = make_piece_world(said, &clock);
  ASSERT_FALSE(eighth);
  EXPECT_THAT(eighth.error().message, HasSubstr("dynamic: pieces are numbered 1 to 7"));
  said.pieces->is_dynamic = false;
  EXPECT_TRUE(make_piece_world(said, &clock));
}

TEST(PieceWorldOfAConfiguration, HasAsManyAxesAsItSays) {
  const sim::VirtualClock clock;
  config::WorldConfig said;
  said.source = "pieces";
  said.pieces = config::PiecesConfig{.cells = 32, .count = 3, .axes = 3};
  const auto made = make_piece_world(said, &clock);
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_EQ(made->world->info().cells, (std::array<std::uint32_t, 3>{32, 32, 32}));
  EXPECT_EQ(made->world->pieces()->board().settings().search, world::cam::SearchKind::Leap);
  EXPECT_DOUBLE_EQ(made->world->info().extent_m[2], 0.09);
}

TEST(PieceWorldOfAConfiguration, IsFollowedAsItSays) {
  const sim::VirtualClock clock;
  config::WorldConfig said;
  said.source = "pieces";
  said.pieces = config::PiecesConfig{.cells = 32, .count = 3};
  const auto search_by = [&](config::PieceSearch search) {
    said.pieces->search = search;
    const auto made = make_piece_world(said, &clock);
    return made.value().world->pieces()->board().settings().search;
  };
  EXPECT_EQ(search_by(config::PieceSearch::Leap), world::cam::SearchKind::Leap);
  EXPECT_EQ(search_by(config::PieceSearch::OneCell), world::cam::SearchKind::OneCell);
  EXPECT_EQ(search_by(config::PieceSearch::Trail), world::cam::SearchKind::BoundedSweep);
}

}  // namespace
}  // namespace thimble::session
