#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/model/cam/cam_torus.hpp"

namespace thimble::sim::cam {

// A scan as it would be told to somebody: site by site, layer by layer, in lockstep. Slow, and
// meant to be checked by reading; what is faster is compared with it.

// A scan of all modules in `which`, 2^end-of-scan sites from each one's scan index on. Formats are
// those of layer 0 of the first. Returns the clocks it took: sites, sweeps and refreshes as they
// came. Without `moves_bits` that is all it does.
std::uint64_t scan(CamTorus& torus, std::span<const std::size_t> which, bool moves_bits = true);

// Of one module, a site for each word: the host's bits are `told`; what its display would show.
std::vector<std::uint16_t> scan_io(CamTorus& torus, std::size_t module,
                                   std::span<const std::uint16_t> told);

}  // namespace thimble::sim::cam
