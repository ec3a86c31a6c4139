#include <array>
#include <string>

#include "daemon/config/schema.hpp"

namespace thimble::config {
namespace {

constexpr std::array kSearches{Choice<PieceSearch>{"leap", PieceSearch::Leap},
                               Choice<PieceSearch>{"one-cell", PieceSearch::OneCell}};

// A number of which a board, or a space on one, has only powers of two.
void read_power(TableReader& reader, std::string_view key, Range range, int& out) {
  std::int64_t number = 0;
  if (!reader.read_integer(key, range, number)) return;
  if ((number & (number - 1)) != 0) {
    return reader.reject(key, "expected a power of two, found " + std::to_string(number));
  }
  out = static_cast<int>(number);
}

PiecesConfig read_pieces_table(TableReader reader) {
  PiecesConfig out;
  read_power(reader, "cells", {32, 512}, out.cells);
  std::int64_t number = 0;
  if (reader.read_integer("count", {1, 63}, number)) out.count = static_cast<int>(number);
  if (reader.read_integer("seed", {0, 9007199254740992.0}, number)) {
    out.seed = static_cast<std::uint64_t>(number);
  }
  reader.read("search", std::span<const Choice<PieceSearch>>(kSearches), out.search);
  read_power(reader, "boards", {1, 8}, out.boards);
  reader.finish();
  return out;
}

}  // namespace

void read_pieces(TableReader& reader, WorldConfig& world) {
  const PiecesConfig pieces = read_pieces_table(reader.table("pieces"));
  if (world.source != kPiecesSource) {
    if (reader.has("pieces") && !world.source.empty()) {
      reader.reject("pieces", "expected only with source \"pieces\", found beside " +
                                  in_quotes(world.source));
    }
    return;
  }
  world.pieces = pieces;
  if (!reader.has("threshold")) return;
  reader.object("threshold", "expected only with a volume file, found beside \"pieces\"");
}

}  // namespace thimble::config
