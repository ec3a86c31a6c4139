#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "cli/picture/picture.hpp"
#include "daemon/api/status.hpp"
#include "daemon/world/cam/automaton.hpp"
#include "hal/base/result.hpp"

namespace thimble::picture {

// The cells of a world that are matter, in one color; its gas is not drawn. Errors: Unsupported for
// a rule that is not known here.
[[nodiscard]] Result<ColorVolume> volume_of(const world::cam::AutomatonState& state);

// Draws the fingers of arms in `world` as white balls: where the hand is with its coordinate
// offset, as each arm had it last.
void add_fingers(ColorVolume& volume, const api::WorldStatus& world, const api::Status& status);

// `thimble snapshot`: a picture of a world that runs by itself, to a PNG file; the exit code.
int run_snapshot(const std::string& socket_path, const std::string& world, const std::string& file);
// The command, told of by `app`; both references must outlive it.
void add_snapshot_command(CLI::App& app, const std::string& socket_path, int& code);

}  // namespace thimble::picture
