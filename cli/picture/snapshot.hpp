#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "cli/cells.hpp"
#include "cli/picture/picture.hpp"
#include "daemon/api/status.hpp"
#include "hal/base/result.hpp"

namespace thimble::picture {

// The cells of a world, pieces in colors by their numbers; those of a small world many times as
// large. One whose front is full is cut in the middle: its front half is left away.
[[nodiscard]] ColorVolume volume_of(const cli::WorldCells& cells);

// Draws fingers as white balls. In a world with pieces it is the grasp point, where its board has
// it: where the hand was one round trip ago, and what was in its way held it. In others: where each
// arm in `world` felt its hand, as api::FeltStatus has it. `every` as WorldCells has it.
void add_fingers(ColorVolume& volume, std::uint32_t every, const api::WorldStatus& world,
                 const api::Status& status);

// `thimble snapshot`: a picture of a world of cells, to a PNG file; the exit code.
int run_snapshot(const std::string& socket_path, const std::string& world, const std::string& file);
// For CLI11's check(): why a picture cannot have the name, as others would take it for something
// else; /dev/stdout is told by whoever it leads to. Pure.
[[nodiscard]] std::string refuse_other_than_png(const std::string& name);
// The command, told of by `app`; both references must outlive it.
void add_snapshot_command(CLI::App& app, const std::string& socket_path, int& code);

}  // namespace thimble::picture
