#pragma once

#include <cstddef>
#include <cstdint>

// A CAM's step over an array of sites, as anyone would write it first: each of the 16 layers is
// read where its kick leads, the table looked up, the layers' ones counted. Sizes are powers of
// two.
struct ReferenceCam {
  unsigned log2_x, log2_y, log2_z;
  int kicks[16][3];
};
void reference_cam_step(const ReferenceCam& cam, const std::uint16_t* table,
                        const std::uint16_t* before, std::uint16_t* after, std::uint64_t* counts);

// As many entries of the table as there are sites: what no way of looking tables up can do without.
void reference_table_lookup(const std::uint16_t* table, const std::uint16_t* sites,
                            std::uint16_t* out, std::size_t count);

// The same by the processor's gather instructions; false where it has none.
bool reference_table_gather(const std::uint16_t* table, const std::uint16_t* sites,
                            std::uint16_t* out, std::size_t count);

// How many bits are set in the shape, moved on by one in rows of 512, and in any of the parts.
std::uint64_t reference_overlap(const std::uint64_t* shape, const std::uint64_t* const* parts,
                                std::size_t part_count, std::size_t words);
