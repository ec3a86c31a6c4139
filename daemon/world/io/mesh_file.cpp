#include "daemon/world/io/mesh_file.hpp"

#include <algorithm>
#include <cctype>
#include <utility>

namespace thimble::world {
namespace {

[[nodiscard]] bool is_obj(const std::string& path) {
  const std::string ending = path.size() < 4 ? path : path.substr(path.size() - 4);
  constexpr std::string_view kObj = ".obj";
  return std::equal(ending.begin(), ending.end(), kObj.begin(), kObj.end(), [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == b;
  });
}

}  // namespace

Result<Mesh> read_mesh_file(const std::string& path) {
  const auto source = open_file(path);
  if (!source) return tl::unexpected(source.error().in(path));
  auto mesh = is_obj(path) ? read_obj(**source) : read_stl(**source);
  if (!mesh) return tl::unexpected(mesh.error().in(path));
  return mesh;
}

Result<DistanceField> load_mesh_field(const std::string& path, const MeshFieldOptions& options) {
  auto mesh = read_mesh_file(path);
  if (!mesh) return tl::unexpected(mesh.error());
  auto field = make_field(*std::move(mesh), options);
  if (!field) return tl::unexpected(field.error().in(path));
  return field;
}

Result<void> check_mesh_file(const std::string& path) {
  auto mesh = read_mesh_file(path);
  if (!mesh) return tl::unexpected(mesh.error());
  weld(*mesh);
  if (auto good = check_closed(*mesh); !good) return tl::unexpected(good.error().in(path));
  return {};
}

}  // namespace thimble::world
