#pragma once

#include <cstddef>
#include <vector>

// One bit a voxel and nothing else, every one of them written.
[[nodiscard]] std::vector<bool> make_reference_bit_volume(std::size_t voxels);
