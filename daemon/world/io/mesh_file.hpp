#pragma once

#include <string>

#include "daemon/world/fields/mesh_field.hpp"
#include "daemon/world/io/byte_source.hpp"
#include "hal/base/result.hpp"

namespace thimble::world {

// Reads triangles. Every number is finite and within ±1e9; corners are as in the file, not welded.
//
// STL, binary (the length that its count asks for) or text: `solid`, `facet`, `outer loop`, three
// `vertex`, `endloop`, `endfacet`, `endsolid`, one a line; normals are not looked at, since the
// corners' order says the same. OBJ: `v` and `f`, polygons as fans; its normals, textures, groups,
// lines and materials are left out, free-form surfaces refused.
//
// Holds 64 KiB of the file and the mesh, kMaxTriangles of them and three times as many corners.
// Errors: Malformed with line or byte, TooLarge, and those of the source; read_mesh_file() puts the
// path in front, and knows the kind of a file by its ending, .stl or .obj in any case.
[[nodiscard]] Result<Mesh> read_stl(ByteSource& source);
[[nodiscard]] Result<Mesh> read_obj(ByteSource& source);
[[nodiscard]] Result<Mesh> read_mesh_file(const std::string& path);

// The field of such a file. Errors: those of read_mesh_file() and make_field().
[[nodiscard]] Result<DistanceField> load_mesh_field(const std::string& path,
                                                    const MeshFieldOptions& options);
// What load_mesh_field() says of the file before it measures distances, which takes its time: that
// it can be read and is closed.
[[nodiscard]] Result<void> check_mesh_file(const std::string& path);

}  // namespace thimble::world
