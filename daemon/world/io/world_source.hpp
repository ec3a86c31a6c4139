#pragma once

#include <memory>
#include <string>

#include "daemon/world/io/volume_writer.hpp"
#include "daemon/world/world.hpp"
#include "hal/base/result.hpp"

namespace thimble::world {

// Builds the world that a configuration's `source` names: "box:N" (the thesis's box of N cells a
// side, 3 to 1024) or the path of a volume, a NumPy file ending in ".npy" or an NRRD file ending in
// ".nrrd" or ".nhdr", relative to the process's current directory. What `options` say of files
// does not touch the box, but for its workspace.
//
// Not RT; reads the file. Errors: one sentence that starts with the source.
[[nodiscard]] Result<std::unique_ptr<World>> make_world(const std::string& source,
                                                        const VolumeOptions& options = {});
// What make_world() would say, without the memory and the time that it takes: everything but the
// numbers within a file (which may leave no cell free). A file is opened and its header read.
// Errors: as make_world().
[[nodiscard]] Result<void> check_world(const std::string& source, const VolumeOptions& options);

}  // namespace thimble::world
