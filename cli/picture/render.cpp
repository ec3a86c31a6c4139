#include <algorithm>
#include <bit>

#include "cli/picture/picture.hpp"
#include "hal/base/check.hpp"
#include "sim/model/cam/engine/plane_engine.hpp"
#include "sim/model/cam/rules/rule.hpp"

namespace thimble::picture {
namespace {

using sim::cam::PlaneEngine;
using sim::cam::PlaneKick;
using sim::cam::SiteSpace;
using Sites = std::vector<std::uint16_t>;

constexpr std::uint32_t kThreeBits = 7;
constexpr std::uint32_t kMatter = kThreeBits << site::kMatterBit;

std::uint32_t field(std::uint32_t site, int bit) { return site >> bit & kThreeBits; }

// Room for the light beside the picture: what leaves it at one side must not come in at the other.
SiteSpace plane_for(const ColorVolume& volume) {
  SiteSpace plane;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const std::size_t cells = std::max<std::size_t>(volume.cells[axis] + volume.cells[2] + 1, 8);
    plane.log2_cells[axis] = static_cast<int>(std::bit_width(cells - 1));
  }
  return plane;
}

std::size_t row_of(const SiteSpace& plane, std::size_t y) { return y << plane.log2_cells[0]; }

void put_slice(const ColorVolume& volume, std::size_t z, const SiteSpace& plane, Sites& sites) {
  for (std::size_t y = 0; y < volume.cells[1]; ++y) {
    for (std::size_t x = 0; x < volume.cells[0]; ++x) {
      std::uint16_t& site = sites[row_of(plane, y) + x];
      const std::size_t cell = x + volume.cells[0] * (y + volume.cells[1] * z);
      site = static_cast<std::uint16_t>((site & ~kMatter) | (volume.colors[cell] & kThreeBits));
    }
  }
}

void check(bool is_good) { THIMBLE_CHECK(is_good); }

}  // namespace

std::uint32_t render_rule(std::uint32_t site) noexcept {
  const std::uint32_t matter = field(site, site::kMatterBit);
  const std::uint32_t light = field(site, site::kLightBit);
  std::uint32_t after = site & ~kMatter;
  if (matter == 0) return after;
  if (field(site, site::kSeenBit) == 0) {
    after |= matter << site::kSeenBit;
    after &= ~(kThreeBits << site::kShadeBit);
    after |= light << site::kShadeBit;
  }
  after &= ~(kThreeBits << site::kLightBit);
  return after | std::min(light + 1, kThreeBits) << site::kLightBit;
}

std::array<std::uint8_t, 3> pixel_of(std::uint32_t color, std::uint32_t shade) noexcept {
  // Ours: what is in the dark is seen, too; a wall that no color is like.
  constexpr std::array<std::uint32_t, 3> kWall{96, 104, 128};
  constexpr std::uint32_t kOn = 240;
  constexpr std::uint32_t kOff = 48;
  std::array<std::uint8_t, 3> pixel{};
  for (std::size_t channel = 0; channel < pixel.size(); ++channel) {
    const std::uint32_t full = color == 0                    ? kWall[channel]
                               : (color >> channel & 1) != 0 ? kOn
                                                             : kOff;
    pixel[channel] = static_cast<std::uint8_t>(full / 4 + ((full - full / 4) >> shade));
  }
  return pixel;
}

Picture render(const ColorVolume& volume, std::size_t pixels) {
  const SiteSpace plane = plane_for(volume);
  auto engine = PlaneEngine::make(plane, sim::cam::TablePath::Auto);
  check(engine.has_value());
  check((*engine)->load(0, sim::cam::table_of(render_rule)).has_value());
  Sites sites(plane.sites());
  const std::vector<PlaneKick> no_kick;
  const std::vector<PlaneKick> light{
      {static_cast<sim::cam::LayerBits>(kThreeBits << site::kLightBit), {1, -1, 0}}};
  for (std::size_t slice = 0; slice < volume.cells[2]; ++slice) {
    put_slice(volume, volume.cells[2] - 1 - slice, plane, sites);
    check((*engine)->put(sites).has_value());
    check((*engine)->step(slice == 0 ? no_kick : light, {}).has_value());
    check((*engine)->get(sites).has_value());
  }
  // On to the wall: no slice is there, so that the light alone moves.
  check((*engine)->step(light, {}).has_value());
  check((*engine)->get(sites).has_value());
  Picture picture{volume.cells[0] * pixels, volume.cells[1] * pixels, {}};
  picture.rgb.reserve(3 * picture.width * picture.height);
  for (std::size_t row = 0; row < picture.height; ++row) {
    const std::size_t y = volume.cells[1] - 1 - row / pixels;
    for (std::size_t column = 0; column < picture.width; ++column) {
      const std::uint32_t site = sites[row_of(plane, y) + column / pixels];
      const std::uint32_t seen = field(site, site::kSeenBit);
      const auto pixel = pixel_of(seen, field(site, seen == 0 ? site::kLightBit : site::kShadeBit));
      picture.rgb.insert(picture.rgb.end(), pixel.begin(), pixel.end());
    }
  }
  return picture;
}

}  // namespace thimble::picture
