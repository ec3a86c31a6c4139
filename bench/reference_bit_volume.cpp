#include "bench/reference_bit_volume.hpp"

std::vector<bool> make_reference_bit_volume(std::size_t voxels) {
  return std::vector<bool>(voxels, true);
}
