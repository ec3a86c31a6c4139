#include "daemon/world/io/mesh_file.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.hpp"
#include "tests/unit/world/npy_bytes.hpp"

namespace thimble::world {
namespace {

Result<Mesh> stl_of(const std::string& text) {
  MemorySource source(bytes_of(text));
  return read_stl(source);
}
Result<Mesh> obj_of(const std::string& text) {
  MemorySource source(bytes_of(text));
  return read_obj(source);
}

const std::string kFacet =
    "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n\tvertex 0 1e0 -0\r\n"
    " endloop\nendfacet\n";

// A head, a count and for each triangle twelve floats, here of which corner i is {i, i + 1, i + 2}.
std::string binary(std::uint32_t count, float bad = 0) {
  std::string out(80, 's');
  const auto put = [&](std::uint32_t word) {
    for (int byte = 0; byte < 4; ++byte) out += static_cast<char>(word >> (8 * byte));
  };
  put(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    for (int k = 0; k < 12; ++k) {
      const float value = k < 3 ? 9.0F : static_cast<float>((k - 3) / 3 + (k - 3) % 3);
      put(std::bit_cast<std::uint32_t>(k == 7 ? value + bad : value));
    }
    out += "ab";
  }
  return out;
}

TEST(StlFile, ReadsTextAndBinary) {
  const auto text = stl_of("solid a name\n" + kFacet + "\n" + kFacet + "endsolid a name\n");
  ASSERT_TRUE(text) << text.error().message;
  ASSERT_EQ(text->triangles.size(), 2U);
  EXPECT_EQ(text->triangles[1], (Mesh::Triangle{3, 4, 5}));
  EXPECT_EQ(text->corners[1], (Position3{1, 0, 0}));
  const auto sut = stl_of(binary(2));
  ASSERT_TRUE(sut) << sut.error().message;
  ASSERT_EQ(sut->corners.size(), 6U);
  EXPECT_EQ(sut->corners[4], (Position3{1, 2, 3}));
}

// Some programs begin a binary file with "solid", too: its length tells.
TEST(StlFile, IsBinaryWhereItsLengthSaysSo) {
  std::string sut = binary(1);
  sut.replace(0, 5, "solid");
  EXPECT_EQ(stl_of(sut)->triangles.size(), 1U);
}

TEST(StlFile, SaysWhatIsWrongAndWhere) {
  const auto said = [](const std::string& text) { return stl_of(text).error().message; };
  EXPECT_EQ(said("solid\nfacet\nouter loop\nvertex 0 0\n"),
            "line 4: expected vertex and three numbers, found 'vertex'");
  EXPECT_EQ(said("solid\nfacet\nvertex 0 0 0\n"), "line 3: expected outer loop, found 'vertex'");
  EXPECT_EQ(said("solid\n" + kFacet + "facet\n"), "mesh: it ends in a triangle");
  EXPECT_EQ(said("solid\nhello\n"), "line 2: expected facet, found 'hello'");
  EXPECT_NE(said("solid " + std::string(9000, 'x')).find("longer than"), std::string::npos);
  EXPECT_NE(said("").find("neither STL text"), std::string::npos);
  EXPECT_NE(said(binary(2).substr(0, 150)).find("neither STL text"), std::string::npos);
  const std::string bad = said(binary(2, std::numeric_limits<float>::infinity()));
  EXPECT_EQ(bad, "mesh: a corner of triangle 0 is not finite, or beyond 1e9");
}

TEST(StlFile, EveryPieceOfAFileIsReadOrRefused) {
  const std::string text = "solid\n" + kFacet + "endsolid\n";
  for (std::size_t size = 0; size < text.size(); ++size) (void)stl_of(text.substr(0, size));
  const std::string whole = binary(2);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    ASSERT_FALSE(stl_of(whole.substr(0, size)));
  }
}

TEST(ObjFile, ReadsFacesOfAnyFormAsFans) {
  const auto sut = obj_of(
      "# a comment\nmtllib x.mtl\no thing\nv 0 0 0\nv 1 0 0 0.5 0.5 0.5\nv 1 1 0\nv 0 1 0\nvn 0 0 "
      "1\n"
      "vt 0 0\nusemtl m\ns off\nf 1/1/1 2//1 3/1 4\nf -4 -1 -2\n");
  ASSERT_TRUE(sut) << sut.error().message;
  EXPECT_EQ(sut->corners.size(), 4U);
  EXPECT_EQ(sut->triangles, (std::vector<Mesh::Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 3, 2}}));
}

TEST(ObjFile, SaysWhatIsWrongAndWhere) {
  const auto said = [](const std::string& text) { return obj_of(text).error().message; };
  EXPECT_EQ(said("v 0 0\n"), "line 1: expected v and three numbers within 1e9");
  EXPECT_EQ(said("v 0 0 nan\n"), "line 1: expected v and three numbers within 1e9");
  EXPECT_EQ(said("v 0 0 1e10\n"), "line 1: expected v and three numbers within 1e9");
  EXPECT_EQ(said("v 0 0 0\n\nf 1 1\n"), "line 3: expected a face of three corners or more");
  for (const char* word : {"2", "0", "-2", "x", "1.5", "99999999999999999999"}) {
    EXPECT_EQ(
        said(std::string("v 0 0 0\nf 1 1 ") + word + "\n"),
        std::string("line 2: expected the number of one of the 1 corners before it, found '") +
            word + "'");
  }
  EXPECT_EQ(said("curv 0 1 1 2\n"), "line 1: expected v or f, found 'curv'");
}

TEST(MeshFile, KnowsItsKindByItsEndingAndSaysItsPath) {
  const testing_support::TemporaryFolder folder;
  const std::string obj = folder.write("a.OBJ", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(read_mesh_file(obj)->triangles.size(), 1U);
  const auto open = check_mesh_file(obj);
  ASSERT_FALSE(open);
  EXPECT_TRUE(open.error().message.starts_with(obj)) << open.error().message;
  EXPECT_NE(open.error().message.find("it is open at the edge from"), std::string::npos);
  EXPECT_EQ(load_mesh_field(obj, {}).error().message, open.error().message);
  EXPECT_FALSE(read_mesh_file(folder.write("b.stl", "v 0 0 0\n")));
  EXPECT_EQ(read_mesh_file(folder / "none.stl").error().code, Errc::NotFound);
}

}  // namespace
}  // namespace thimble::world
