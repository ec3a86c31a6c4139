#include "cli/picture/snapshot.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>

#include "cli/ask.hpp"
#include "cli/commands.hpp"
#include "cli/file_text.hpp"
#include "cli/text.hpp"
#include "daemon/world/cam/automaton_file.hpp"
#include "sim/model/cam/rules/rule.hpp"

namespace thimble::picture {
namespace {

constexpr std::size_t kLeastPixels = 512;  // of the picture's longer edge, if whole cells make it
constexpr std::uint8_t kFinger = 7;

constexpr std::uint8_t kMatterColor = 6;

// Of the cell that a coordinate is in, and beyond the ends where it is.
double place_of(double at_m, const api::WorldStatus& world, std::size_t axis) {
  return at_m / world.cell_m + 0.5 * world.cells[axis] - 0.5;
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
  const auto body = cli::ask(client, "GET", "/v1/worlds/" + world->name + "/state");
  if (!body) return tl::unexpected(body.error());
  const auto state = world::cam::parse_state(*body);
  if (!state) return tl::unexpected(state.error());
  auto volume = volume_of(*state);
  if (!volume) return tl::unexpected(volume.error());
  add_fingers(*volume, *world, *status);
  const std::size_t longer = std::max(volume->cells[0], volume->cells[1]);
  return render(*volume, std::max<std::size_t>(1, kLeastPixels / longer));
}

}  // namespace

Result<ColorVolume> volume_of(const world::cam::AutomatonState& state) {
  const sim::cam::Rule* const rule = sim::cam::find_rule(state.rule);
  if (rule == nullptr) return fail(Errc::Unsupported, "a world of a rule that is not known here");
  const std::uint16_t matter = rule->visible_layers();
  ColorVolume volume;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    volume.cells[axis] = std::size_t{1} << state.log2_cells[axis];
  }
  volume.colors.reserve(state.sites.size());
  for (const std::uint16_t site : state.sites) {
    volume.colors.push_back((site & matter) != 0 ? kMatterColor : 0);
  }
  return volume;
}

void add_fingers(ColorVolume& volume, const api::WorldStatus& world, const api::Status& status) {
  if (!(world.cell_m > 0)) return;
  for (const api::ArmStatus& arm : status.arms) {
    if (arm.world != world.name) continue;
    std::array<double, 3> center{};
    bool is_somewhere = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      center[axis] = place_of(arm.position_m[axis] + arm.offset_m[axis], world, axis);
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
