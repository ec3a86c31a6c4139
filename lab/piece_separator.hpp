#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "daemon/world/cam/piece_board.hpp"
#include "hal/base/result.hpp"

// The thesis's demonstration (4.2.1): a program that moves pieces at random until each can be moved
// by itself. Also the soak test of the board: what it says is compared with where pieces must be.
namespace thimble::lab {

// Pieces that fill the middle quarter of a plane and interlock with teeth, `across` times `across`
// of them. Same seed, same teeth. Errors: InvalidArgument where they would be thinner than
// kLeastThickness_cells, or more than kMostPieces.
[[nodiscard]] Result<world::cam::PieceLayout> interlocking_layout(const CamGeometry& space,
                                                                  int across, std::uint64_t seed);

struct SeparatorReport {
  int pieces{0};
  int apart{0};  // that can go one cell each way
  std::uint64_t moves{0};
  std::uint64_t blocked{0};  // of these: that ended before they were to
  bool operator==(const SeparatorReport&) const = default;
};

// Until all are apart, or so many moves. `wait`: lets the board go on until it is ready.
// Errors: the board's, and System where it is not as the host knows it must be.
class PieceSeparator {
 public:
  using Wait = std::function<Result<void>()>;
  PieceSeparator(world::cam::PieceBoard& board, const world::cam::PieceLayout& layout,
                 std::uint64_t seed, Wait wait);
  [[nodiscard]] Result<SeparatorReport> run(std::uint64_t most_moves);

 private:
  struct Piece {
    int number{0};
    CamAxes at{};  // one of its cells
    bool is_apart{false};
  };

  [[nodiscard]] std::vector<Piece*> stuck_pieces();
  // Moves it once where it is not free.
  [[nodiscard]] Result<void> free_up(Piece& piece);
  [[nodiscard]] Result<void> take(const Piece& piece);
  [[nodiscard]] Result<void> drop(Piece& piece);
  // Cells that it went.
  [[nodiscard]] Result<CamAxes> go(const CamAxes& by);
  [[nodiscard]] Result<void> act(world::cam::PieceAction action, world::cam::PieceOutcome expected);
  [[nodiscard]] Result<void> move_somewhere();
  [[nodiscard]] Result<bool> goes_each_way();
  [[nodiscard]] Result<void> look(Piece& piece);
  [[nodiscard]] int below(int count);

  world::cam::PieceBoard* board_;
  CamAxes cells_;
  std::vector<Piece> pieces_;
  std::uint64_t random_;
  Wait wait_;
  SeparatorReport report_;
};

// The pieces that people see moved apart: 16, in 128 x 128 cells. Errors: none.
inline constexpr CamGeometry kSeparatorSpace{{7, 7, 0}, CamDivision::StripY};
[[nodiscard]] Result<world::cam::PieceLayout> separator_layout(std::uint64_t seed);

// Of these on a board of eight modules, for people.
// Errors: as the separator's, and System where they were not apart in the end.
[[nodiscard]] Result<std::string> report_separator(std::uint64_t seed);

}  // namespace thimble::lab
