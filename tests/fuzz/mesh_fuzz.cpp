#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "daemon/world/io/mesh_file.hpp"
#include "hal/base/check.hpp"
#include "tests/fuzz/sentence.hpp"

namespace {

using thimble::Result;
using thimble::world::Mesh;

void judge(Result<Mesh> mesh, std::size_t size) {
  if (!mesh) return thimble::fuzz::require_sentence(mesh.error(), 256);
  THIMBLE_CHECK(mesh->triangles.size() <= size && mesh->corners.size() <= size);
  for (const Mesh::Triangle& triangle : mesh->triangles) {
    for (const std::uint32_t corner : triangle) THIMBLE_CHECK(corner < mesh->corners.size());
  }
  const auto field = make_field(*std::move(mesh), {.resolution = 8});
  if (!field) return thimble::fuzz::require_sentence(field.error(), 512);
  THIMBLE_CHECK(field->steepest() >= 1);
}

}  // namespace

// Any bytes give a mesh, and that a field, or one short printable sentence.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  thimble::world::MemorySource stl(bytes);
  judge(thimble::world::read_stl(stl), size);
  thimble::world::MemorySource obj(bytes);
  judge(thimble::world::read_obj(obj), size);
  return 0;
}
