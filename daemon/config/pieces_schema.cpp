#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "daemon/config/schema.hpp"

namespace thimble::config {
namespace {

constexpr std::array kSearches{Choice<PieceSearch>{"leap", PieceSearch::Leap},
                               Choice<PieceSearch>{"trail", PieceSearch::Trail},
                               Choice<PieceSearch>{"one-cell", PieceSearch::OneCell}};

constexpr std::array kBoardKinds{Choice<PieceBoardKind>{"sim", PieceBoardKind::Sim},
                                 Choice<PieceBoardKind>{"sim-usb", PieceBoardKind::SimUsb},
                                 Choice<PieceBoardKind>{"usb", PieceBoardKind::Usb},
                                 Choice<PieceBoardKind>{"pci", PieceBoardKind::Pci}};

// Ours: as many cells in three axes as the thesis's worlds have.
constexpr int kMostCellsInSpace = 64;

// A file says itself what the others say.
void read_layout(TableReader& reader, const std::filesystem::path& folder, PiecesConfig& out) {
  read_path(reader, "layout", folder, out.layout);
  if (!out.layout) return;
  if (!is_volume_file(*out.layout)) {
    reader.reject("layout", "expected the path of an .npy, .nrrd or .nhdr file, found " +
                                in_quotes(*out.layout));
  }
  for (const char* key : {"cells", "axes", "count", "seed"}) {
    if (reader.has(key)) reader.reject(key, "expected only without layout, whose file says it");
  }
}

// Ours: as many as numbers of three bits are; the other layers are the particles'.
constexpr int kMostDynamic = 7;

// `is_counted`: `count` is there and good by itself.
void limit_dynamic(TableReader& reader, bool is_counted, PiecesConfig& out) {
  if (!is_counted) out.count = kMostDynamic;
  if (out.count <= kMostDynamic) return;
  reader.reject("count", "expected at most " + std::to_string(kMostDynamic) +
                             " with dynamic = true, found " + std::to_string(out.count));
}

PiecesConfig read_pieces_table(TableReader reader, const std::filesystem::path& folder) {
  PiecesConfig out;
  read_power(reader, "cells", {32, 512}, out.cells);
  std::int64_t number = 0;
  const bool is_counted = reader.read_integer("count", {1, 63}, number);
  if (is_counted) out.count = static_cast<int>(number);
  if (reader.read_integer("seed", {0, 9007199254740992.0}, number)) {
    out.seed = static_cast<std::uint64_t>(number);
  }
  reader.read("search", std::span<const Choice<PieceSearch>>(kSearches), out.search);
  reader.read("dynamic", out.is_dynamic);
  reader.read("pressure_newton_per_m", {0, 20000, true}, out.pressure_newton_per_m);
  // Ours: a picture in two minutes of a hand at rest, which is looked for ten times a second.
  if (reader.read_integer("display_every", {1, 1000}, number)) {
    out.display_every = static_cast<int>(number);
  }
  if (out.is_dynamic) limit_dynamic(reader, is_counted, out);
  read_power(reader, "boards", {1, 8}, out.boards);
  reader.read("board", std::span<const Choice<PieceBoardKind>>(kBoardKinds), out.board);
  const bool is_real = out.board == PieceBoardKind::Usb || out.board == PieceBoardKind::Pci;
  if (is_real && reader.has("boards")) {
    reader.reject("boards", "expected only of a simulated board, found beside a real one");
  }
  if (reader.read_integer("axes", {2, 3}, number)) out.axes = static_cast<int>(number);
  if (out.axes == 3 && !reader.has("cells")) out.cells = kMostCellsInSpace;
  if (out.axes == 3 && out.cells > kMostCellsInSpace) {
    reader.reject("cells", "expected at most " + std::to_string(kMostCellsInSpace) +
                               " with axes = 3, found " + std::to_string(out.cells));
  }
  read_layout(reader, folder, out);
  reader.finish();
  return out;
}

}  // namespace

// Of which a board, or a space on one, has no others.
void read_power(TableReader& reader, std::string_view key, Range range, int& out) {
  std::int64_t number = 0;
  if (!reader.read_integer(key, range, number)) return;
  if ((number & (number - 1)) != 0) {
    return reader.reject(key, "expected a power of two, found " + std::to_string(number));
  }
  out = static_cast<int>(number);
}

void read_path(TableReader& reader, std::string_view key, const std::filesystem::path& folder,
               std::optional<std::string>& out) {
  std::string path;
  if (!reader.read(key, path)) return;
  // Typed on a command line, a path means the place where it is typed.
  out = reader.is_override(key) ? path : (folder / path).lexically_normal().string();
}

void read_pieces(TableReader& reader, const std::filesystem::path& folder, WorldConfig& world) {
  const PiecesConfig pieces = read_pieces_table(reader.table("pieces"), folder);
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
