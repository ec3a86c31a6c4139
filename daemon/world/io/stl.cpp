#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "daemon/world/io/buffered_source.hpp"
#include "daemon/world/io/mesh_file.hpp"
#include "daemon/world/io/mesh_numbers.hpp"
#include "daemon/world/io/quoted.hpp"
#include "daemon/world/io/text_lines.hpp"

namespace thimble::world {
namespace {

// The format of 3D Systems, 1989: 80 bytes of anything, a count, and of each triangle twelve
// little-endian floats (normal, three corners) and two bytes more.
constexpr std::size_t kHeadBytes = 84;
constexpr std::size_t kCountAt = 80;
constexpr std::size_t kTriangleBytes = 50;

[[nodiscard]] std::uint32_t word_at(std::span<const std::byte> bytes, std::size_t at) noexcept {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4; ++i)
    word |= std::to_integer<std::uint32_t>(bytes[at + i]) << 8 * i;
  return word;
}

[[nodiscard]] double float_at(std::span<const std::byte> bytes, std::size_t at) noexcept {
  return double{std::bit_cast<float>(word_at(bytes, at))};
}

[[nodiscard]] Error too_many() {
  return {Errc::TooLarge, "mesh: more than " + std::to_string(kMaxTriangles) + " triangles"};
}

[[nodiscard]] Result<Mesh> read_binary(BufferedSource& source, std::uint32_t count) {
  if (count > kMaxTriangles) return tl::unexpected(too_many());
  std::array<std::byte, kHeadBytes> head{};
  if (auto got = source.read(head); !got) return tl::unexpected(got.error());
  Mesh mesh;
  mesh.corners.reserve(3 * std::size_t{count});
  mesh.triangles.reserve(count);
  std::array<std::byte, kTriangleBytes> bytes{};
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto got = source.read(bytes);
    if (!got) return tl::unexpected(got.error());
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::size_t at = 12 + 12 * corner;
      const Position3 place{float_at(bytes, at), float_at(bytes, at + 4), float_at(bytes, at + 8)};
      if (*got == bytes.size() && is_corner(place)) {
        mesh.corners.push_back(place);
        continue;
      }
      return fail(Errc::Malformed, "mesh: a corner of triangle " + std::to_string(i) +
                                       " is not finite, or beyond 1e9");
    }
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

// The text's grammar, a line at a time.
class StlText {
 public:
  explicit StlText(BufferedSource& source) : lines_(source) {}

  [[nodiscard]] Result<Mesh> read() {
    for (;;) {
      const auto more = lines_.next();
      if (!more) return tl::unexpected(more.error());
      if (!*more) break;
      if (lines_.words().empty()) continue;
      if (auto good = take(); !good) return tl::unexpected(good.error());
    }
    if (expected_ != Expected::Facet) return fail(Errc::Malformed, "mesh: it ends in a triangle");
    return std::move(mesh_);
  }

 private:
  enum class Expected { Facet, Loop, Corner, EndLoop, EndFacet };

  [[nodiscard]] Result<void> take() {
    const auto& words = lines_.words();
    const std::string_view word = words[0];
    switch (expected_) {
      case Expected::Facet:
        if (word == "solid" || word == "endsolid") return {};
        return step(word == "facet", "facet", Expected::Loop);
      case Expected::Loop:
        corners_ = 0;
        return step(word == "outer", "outer loop", Expected::Corner);
      case Expected::Corner:
        return take_corner();
      case Expected::EndLoop:
        return step(word == "endloop", "endloop", Expected::EndFacet);
      case Expected::EndFacet:
        return step(word == "endfacet", "endfacet", Expected::Facet);
    }
    return {};
  }
  [[nodiscard]] Result<void> step(bool is_there, const char* what, Expected next) {
    if (!is_there) {
      return fail(Errc::Malformed,
                  lines_.place() + ": expected " + what + ", found " + quoted(lines_.words()[0]));
    }
    expected_ = next;
    return {};
  }
  [[nodiscard]] Result<void> take_corner() {
    const auto& words = lines_.words();
    Position3 at;
    if (words.size() != 4 || words[0] != "vertex" ||
        !parse_corner(words[1], words[2], words[3], at)) {
      return fail(Errc::Malformed, lines_.place() + ": expected vertex and three numbers, found " +
                                       quoted(words[0]));
    }
    mesh_.corners.push_back(at);
    if (++corners_ < 3) return {};
    if (mesh_.triangles.size() == kMaxTriangles) {
      return tl::unexpected(too_many());
    }
    const auto end = static_cast<std::uint32_t>(mesh_.corners.size());
    mesh_.triangles.push_back({end - 3, end - 2, end - 1});
    expected_ = Expected::EndLoop;
    return {};
  }

  TextLines lines_;
  Mesh mesh_{};
  Expected expected_{Expected::Facet};
  int corners_{0};
};

}  // namespace

Result<Mesh> read_stl(ByteSource& source) {
  BufferedSource buffered(source);
  const auto ahead = buffered.peek();
  if (!ahead) return tl::unexpected(ahead.error());
  if (ahead->size() >= kHeadBytes) {
    const std::uint32_t count = word_at(*ahead, kCountAt);
    if (buffered.size() == kHeadBytes + std::uint64_t{kTriangleBytes} * count) {
      return read_binary(buffered, count);
    }
  }
  constexpr std::string_view kSolid = "solid";
  const std::string_view text(reinterpret_cast<const char*>(ahead->data()), ahead->size());
  if (text.starts_with(kSolid)) return StlText(buffered).read();
  return fail(Errc::Malformed,
              "mesh: neither STL text, which starts with solid, nor as long as its count of "
              "triangles asks for");
}

}  // namespace thimble::world
