#include "cli/picture/snapshot.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>

#include "cli/ask.hpp"
#include "cli/commands.hpp"
#include "cli/file_text.hpp"
#include "cli/text.hpp"

namespace thimble::picture {
namespace {

constexpr std::size_t kLeastPixels = 512;  // of the picture's longer edge, if whole cells make it
constexpr std::uint8_t kFinger = 7;

// White is the fingers', and that of particles, which are specks. Matter without a number is 1, and
// has the color of piece 1.
std::uint8_t color_of(std::uint8_t value) {
  constexpr std::array<std::uint8_t, 6> kColors{6, 3, 2, 5, 1, 4};
  if (value == cli::kParticleValue) return kFinger;
  return value == 0 ? 0 : kColors[(value - 1U) % kColors.size()];
}

// So many times is each cell of a small world drawn along each axis: a finger is a small ball in
// it. An axis of one cell stays flat.
std::size_t times_of(const std::array<std::uint32_t, 3>& sizes) {
  constexpr std::uint32_t kLeastCells = 64;  // as the thesis's worlds in space
  return std::max(1U, kLeastCells / *std::max_element(sizes.begin(), sizes.end()));
}

// A closed front would be all that is seen, as of a box: such a world is cut in the middle.
void cut_open(ColorVolume& volume) {
  const auto slice = static_cast<std::ptrdiff_t>(volume.cells[0] * volume.cells[1]);
  auto& colors = volume.colors;
  if (std::find(colors.end() - slice, colors.end(), 0) != colors.end()) return;
  if (volume.cells[2] == 1) return;
  const auto kept = slice * static_cast<std::ptrdiff_t>((volume.cells[2] + 1) / 2);
  std::fill(colors.begin() + kept, colors.end(), std::uint8_t{0});
}

// Of the volume's cell that a coordinate is in, and beyond the ends where it is.
double place_of(double at_m, const api::WorldStatus& world, double times, std::size_t axis) {
  return (at_m / world.cell_m + 0.5 * world.cells[axis]) * times - 0.5;
}

// The middle of the cell.
std::array<double, 3> grasp_point(const api::PiecesStatus& pieces, double times) {
  std::array<double, 3> center{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    center[axis] = (pieces.grasp_cell[axis] + 0.5) * times - 0.5;
  }
  return center;
}

void add_ball(ColorVolume& volume, const std::array<double, 3>& center) {
  const std::size_t longest = *std::max_element(volume.cells.begin(), volume.cells.end());
  const double radius = std::max(1.25, static_cast<double>(longest) / 64);
  std::array<std::ptrdiff_t, 3> first{};
  std::array<std::ptrdiff_t, 3> last{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double end = static_cast<double>(volume.cells[axis]) - 1;
    // A plane has no depth: there the finger is wherever the hand is.
    const double at = volume.cells[axis] == 1 ? 0 : center[axis];
    first[axis] = static_cast<std::ptrdiff_t>(std::clamp(std::ceil(at - radius), 0.0, end + 1));
    last[axis] = static_cast<std::ptrdiff_t>(std::clamp(std::floor(at + radius), -1.0, end));
  }
  for (std::ptrdiff_t z = first[2]; z <= last[2]; ++z) {
    for (std::ptrdiff_t y = first[1]; y <= last[1]; ++y) {
      for (std::ptrdiff_t x = first[0]; x <= last[0]; ++x) {
        const double dx = static_cast<double>(x) - center[0];
        const double dy = static_cast<double>(y) - center[1];
        const double dz = volume.cells[2] == 1 ? 0 : static_cast<double>(z) - center[2];
        if (dx * dx + dy * dy + dz * dz > radius * radius) continue;
        const auto cell = static_cast<std::size_t>(x) +
                          volume.cells[0] * (static_cast<std::size_t>(y) +
                                             volume.cells[1] * static_cast<std::size_t>(z));
        volume.colors[cell] = kFinger;
      }
    }
  }
}

Result<Picture> take(cli::Client& client, const std::string& name) {
  const auto status = cli::ask_status(client);
  if (!status) return tl::unexpected(status.error());
  const auto world = cli::find_world(*status, name);
  if (!world) return tl::unexpected(world.error());
  const auto body = cli::ask(client, "GET", "/v1/worlds/" + world->name + "/cells");
  if (!body) return tl::unexpected(body.error());
  const auto cells = cli::parse_cells(*body);
  if (!cells) return tl::unexpected(cells.error());
  // Once more, as new as the cells: these may have been waited for.
  const auto as_new = cli::ask_status(client);
  if (!as_new) return tl::unexpected(as_new.error());
  const auto there = cli::find_world(*as_new, world->name);
  if (!there) return tl::unexpected(there.error());
  ColorVolume volume = volume_of(*cells);
  add_fingers(volume, cells->every, *there, *as_new);
  const std::size_t longer = std::max(volume.cells[0], volume.cells[1]);
  return render(volume, std::max<std::size_t>(1, kLeastPixels / longer));
}

}  // namespace

ColorVolume volume_of(const cli::WorldCells& cells) {
  const std::size_t times = times_of(cells.sizes);
  ColorVolume volume;
  std::size_t count = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    volume.cells[axis] = cells.sizes[axis] > 1 ? cells.sizes[axis] * times : 1;
    count *= volume.cells[axis];
  }
  volume.colors.reserve(count);
  for (std::size_t z = 0; z < volume.cells[2]; ++z) {
    for (std::size_t y = 0; y < volume.cells[1]; ++y) {
      for (std::size_t x = 0; x < volume.cells[0]; ++x) {
        const std::size_t from =
            x / times + cells.sizes[0] * (y / times + cells.sizes[1] * (z / times));
        volume.colors.push_back(color_of(static_cast<std::uint8_t>(cells.values[from])));
      }
    }
  }
  cut_open(volume);
  return volume;
}

void add_fingers(ColorVolume& volume, std::uint32_t every, const api::WorldStatus& world,
                 const api::Status& status) {
  if (!(world.cell_m > 0) || every == 0) return;
  const auto longest = static_cast<std::size_t>(
      std::max_element(world.cells.begin(), world.cells.end()) - world.cells.begin());
  // What each of its cells is drawn as, or the other way around.
  const std::size_t shown = (world.cells[longest] + every - 1) / every;
  if (shown == 0) return;
  const std::size_t drawn_as = volume.cells[longest] / shown;  // whole: a cell is drawn as cells
  const double times = static_cast<double>(drawn_as) / every;
  if (world.pieces) return add_ball(volume, grasp_point(*world.pieces, times));
  for (const api::ArmStatus& arm : status.arms) {
    if (arm.world != world.name) continue;
    std::array<double, 3> center{};
    bool is_somewhere = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      center[axis] = place_of(arm.felt.position_m[axis], world, times, axis);
      is_somewhere = is_somewhere && std::isfinite(center[axis]);
    }
    if (is_somewhere) add_ball(volume, center);
  }
}

int run_snapshot(const std::string& socket_path, const std::string& world,
                 const std::string& file) {
  auto client = cli::connect_to_daemon(socket_path);
  if (!client) return cli::complain(client.error());
  const auto picture = take(**client, world);
  if (!picture) return cli::complain(picture.error());
  if (const auto written = cli::write_whole(file, to_png(*picture)); !written) {
    return cli::complain(written.error().in(file));
  }
  std::cout << cli::plain(file) << ": " << picture->width << " x " << picture->height
            << " pixels\n";
  return cli::kExitOk;
}

}  // namespace thimble::picture
