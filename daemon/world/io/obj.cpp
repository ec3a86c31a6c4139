#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "daemon/world/io/buffered_source.hpp"
#include "daemon/world/io/mesh_file.hpp"
#include "daemon/world/io/mesh_numbers.hpp"
#include "daemon/world/io/quoted.hpp"
#include "daemon/world/io/text_lines.hpp"

namespace thimble::world {
namespace {

constexpr std::size_t kMaxCorners = 3 * kMaxTriangles;
// Of Wavefront's format, what changes nothing of where the faces are.
constexpr std::array<std::string_view, 11> kLeftOut{"vn", "vt", "vp",     "g",      "o", "s",
                                                    "l",  "p",  "usemtl", "mtllib", "mg"};

class Obj {
 public:
  explicit Obj(BufferedSource& source) : lines_(source) {}

  [[nodiscard]] Result<Mesh> read() {
    for (;;) {
      const auto more = lines_.next();
      if (!more) return tl::unexpected(more.error());
      if (!*more) return std::move(mesh_);
      if (lines_.words().empty() || lines_.words()[0].front() == '#') continue;
      if (auto good = take(lines_.words()[0]); !good) return tl::unexpected(good.error());
    }
  }

 private:
  [[nodiscard]] Result<void> take(std::string_view word) {
    if (word == "v") return take_corner();
    if (word == "f") return take_face();
    if (std::find(kLeftOut.begin(), kLeftOut.end(), word) != kLeftOut.end()) return {};
    return fail(Errc::Malformed, lines_.place() + ": expected v or f, found " + quoted(word));
  }
  // Colors or a weight may stand behind.
  [[nodiscard]] Result<void> take_corner() {
    const auto& words = lines_.words();
    Position3 at;
    if (words.size() < 4 || !parse_corner(words[1], words[2], words[3], at)) {
      return fail(Errc::Malformed, lines_.place() + ": expected v and three numbers within 1e9");
    }
    if (mesh_.corners.size() == kMaxCorners) {
      return fail(Errc::TooLarge, "mesh: more than " + std::to_string(kMaxCorners) + " corners");
    }
    mesh_.corners.push_back(at);
    return {};
  }
  // `word`: a number, perhaps with those of texture and normal behind slashes; from the end if < 0.
  [[nodiscard]] bool parse_index(std::string_view word, std::uint32_t& out) const noexcept {
    std::int64_t number = 0;
    if (!parse_number(word.substr(0, word.find('/')), number)) return false;
    const auto count = static_cast<std::int64_t>(mesh_.corners.size());
    if (number == 0 || number > count || number < -count) return false;
    out = static_cast<std::uint32_t>(number > 0 ? number - 1 : count + number);
    return true;
  }
  [[nodiscard]] Result<void> take_face() {
    const auto& words = lines_.words();
    if (words.size() < 4) {
      return fail(Errc::Malformed, lines_.place() + ": expected a face of three corners or more");
    }
    Mesh::Triangle fan{};
    for (std::size_t i = 1; i < words.size(); ++i) {
      std::uint32_t corner = 0;
      if (!parse_index(words[i], corner)) {
        return fail(Errc::Malformed, lines_.place() + ": expected the number of one of the " +
                                         std::to_string(mesh_.corners.size()) +
                                         " corners before it, found " + quoted(words[i]));
      }
      fan[std::min<std::size_t>(i - 1, 2)] = corner;
      if (i < 3) continue;
      if (mesh_.triangles.size() == kMaxTriangles) {
        return fail(Errc::TooLarge,
                    "mesh: more than " + std::to_string(kMaxTriangles) + " triangles");
      }
      mesh_.triangles.push_back(fan);
      fan[1] = corner;
    }
    return {};
  }

  TextLines lines_;
  Mesh mesh_{};
};

}  // namespace

Result<Mesh> read_obj(ByteSource& source) {
  BufferedSource buffered(source);
  return Obj(buffered).read();
}

}  // namespace thimble::world
