#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "drivers/cambus/cambus_registers.hpp"
#include "sim/model/cam/cam_torus.hpp"
#include "sim/model/cam/sync_pulses.hpp"
#include "sim/model/cam/video_monitor.hpp"

namespace thimble::sim::cam {

// A scan as it would be told to somebody: site by site, layer by layer, in lockstep. Slow, and
// meant to be checked by reading; what is faster is compared with it.

// What a synchronized scan waits for before each sweep, the first by its mode, and who sees what is
// shown in them.
struct ScanSync {
  const SyncPulses& pulses;
  std::uint64_t now_clocks{0};
  std::uint32_t mode{cambus::kSyncLine};
  VideoMonitor& monitor;
};

[[nodiscard]] bool shows_scan(const CamModule& module) noexcept;
// Whose display goes to the video port, as in `which`: the first that shows its scan.
[[nodiscard]] std::optional<std::size_t> module_on_video(const CamTorus& torus,
                                                         std::span<const std::size_t> which);

// A scan of all modules in `which`, 2^end-of-scan sites from each one's scan index on. Formats are
// those of layer 0 of the first. Returns the clocks it took: waiting, sites, sweeps and refreshes
// as they came. Without `moves_bits` that is all it does. `sync`: nothing for a free run.
std::uint64_t scan(CamTorus& torus, std::span<const std::size_t> which, bool moves_bits = true,
                   const ScanSync* sync = nullptr);

// Of one module, a site for each word: the host's bits are `told`; what its display would show.
std::vector<std::uint16_t> scan_io(CamTorus& torus, std::size_t module,
                                   std::span<const std::uint16_t> told);

}  // namespace thimble::sim::cam
