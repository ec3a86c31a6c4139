#include "daemon/session/combination.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "daemon/session/live_settings.hpp"
#include "daemon/session/piece_settings.hpp"
#include "daemon/world/block_world.hpp"
#include "daemon/world/fields/field_world.hpp"
#include "daemon/world/shapes/shape_world.hpp"
#include "daemon/world/sphere_world.hpp"
#include "daemon/world/voxel_world.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::session {
namespace {

using Row = std::vector<std::string>;

Row cells_of(const std::string& line) {
  Row cells;
  std::istringstream in(line.substr(1));
  for (std::string cell; std::getline(in, cell, '|');) {
    const auto first = cell.find_first_not_of(' ');
    const auto last = cell.find_last_not_of(' ');
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
  }
  return cells;
}

// The rows of the page's matrix by the name of the world; its header under "world".
std::map<std::string, Row> matrix() {
  std::ifstream page(THIMBLE_SOURCE_DIR "/docs/worlds-and-schemes.md");
  std::map<std::string, Row> rows;
  for (std::string line; std::getline(page, line);) {
    if (!line.starts_with("| world |") && rows.empty()) continue;
    if (!line.starts_with("|")) break;
    const Row cells = cells_of(line);
    rows.emplace(cells.front(), cells);
  }
  return rows;
}

const std::map<std::string, Row>& page() {
  static const std::map<std::string, Row> kRows = matrix();
  return kRows;
}

// What the page says of a world and a column: empty, or the words after "refused: ".
std::string reason_on_page(const std::string& world, const std::string& column) {
  const Row& header = page().at("world");
  for (std::size_t i = 1; i < header.size(); ++i) {
    if (header[i] != column) continue;
    const std::string& said = page().at(world)[i];
    EXPECT_TRUE(said == "there" || said.starts_with("refused: ")) << said;
    return said == "there" ? "" : said.substr(std::string("refused: ").size());
  }
  ADD_FAILURE() << "no column " << column;
  return {};
}

void expect_as_on_page(const std::string& world, const std::string& column,
                       const Result<void>& result) {
  const std::string reason = reason_on_page(world, column);
  EXPECT_EQ(result.has_value(), reason.empty()) << world << ", " << column;
  if (result || reason.empty()) return;
  EXPECT_EQ(result.error().code, Errc::Unsupported);
  EXPECT_NE(result.error().message.find(reason), std::string::npos) << result.error().message;
}

std::unique_ptr<world::World> live_world(const std::string& source, int axes) {
  config::WorldConfig said;
  said.source = source;
  said.automaton = config::AutomatonConfig{.axes = axes, .cells = 32};
  return make_live_world(said).value();
}

MadeWorld piece_world(const Clock& clock, std::optional<config::PieceSearch> search = {}) {
  config::WorldConfig said;
  said.source = "pieces";
  said.pieces = config::PiecesConfig{.cells = 32, .count = 3};
  if (search) said.pieces->search = *search;
  return make_piece_world(said, &clock).value();
}

TEST(Combination, IsAcceptedOrRefusedWithItsReasonAsTheMatrixSays) {
  const world::VoxelWorld with_cells(world::make_box(3).value(), "box:3");
  const auto sphere = world::SphereWorld::create({{}, 0.02, -0.02});
  ASSERT_TRUE(sphere);
  const auto shapes = world::ShapeWorld::create({{.radius_m = 0.02}});
  ASSERT_TRUE(shapes);
  auto numbers = world::DistanceField::create({2, 2, 2}, 0.01, {-1, -1, 1, 1, -1, -1, 1, 1});
  ASSERT_TRUE(numbers);
  const world::FieldWorld field(*std::move(numbers), "ball.npy");
  const auto block = world::BlockWorld::create({});
  ASSERT_TRUE(block);
  const sim::VirtualClock clock;
  const MadeWorld pieces = piece_world(clock);
  const MadeWorld by_trail = piece_world(clock, config::PieceSearch::Trail);
  const auto life = live_world("life", 2);
  const auto flat = live_world("crystal", 2);
  const auto crystal = live_world("crystal", 3);
  const std::map<std::string, const world::World*> worlds{
      {"with cells", &with_cells},
      {"`sphere`", &*sphere},
      {"`shapes`", &*shapes},
      {"of a field", &field},
      {"`block`", &*block},
      {"`pieces`", pieces.world.get()},
      {"`pieces` by trail", by_trail.world.get()},
      {"`life`", life.get()},
      {"`crystal` in a plane", flat.get()},
      {"`crystal` in space", crystal.get()}};
  ASSERT_EQ(page().at("world").size(), 13U) << "a new column needs a line here";
  ASSERT_EQ(page().size(), 1 + 1 + worlds.size()) << "a new row needs a world here";
  for (const auto& [name, world] : worlds) {
    config::WorldConfig said;
    config::CouplingConfig arm;
    expect_as_on_page(name, "model `ghost-point`", check_combination(*world, said));
    expect_as_on_page(name, "scheme `ghost-point`", check_combination(*world, arm));
    arm.scheme = config::CouplingScheme::ThesisLiteral;
    expect_as_on_page(name, "scheme `thesis-literal`", check_combination(*world, arm));
    arm.scheme = config::CouplingScheme::RemoteForce;
    expect_as_on_page(name, "scheme `remote-force`", check_combination(*world, arm));
    arm.scheme = config::CouplingScheme::SpringDamper;
    expect_as_on_page(name, "scheme `spring-damper`", check_combination(*world, arm));
    arm.scheme = config::CouplingScheme::Wave;
    expect_as_on_page(name, "scheme `wave`", check_combination(*world, arm));
    arm.scheme = config::CouplingScheme::ConstraintPlane;
    expect_as_on_page(name, "scheme `constraint-plane`", check_combination(*world, arm));
    arm.scheme = config::CouplingScheme::BufferZone;
    arm.buffer_m = 0.010;
    expect_as_on_page(name, "scheme `buffer-zone`", check_combination(*world, arm));
    arm.zone = config::CouplingZone::Faces;
    expect_as_on_page(name, "its `faces`", check_combination(*world, arm));
    arm.scheme = config::CouplingScheme::Composite;
    expect_as_on_page(name, "scheme `composite`", check_combination(*world, arm));
    said.listen = config::UdpEndpoint{"127.0.0.1", 5001};
    expect_as_on_page(name, "`listen`", check_combination(*world, said));
    said.listen.reset();
    said.constraint_model = config::ConstraintModel::Simple;
    expect_as_on_page(name, "model `simple`", check_combination(*world, said));
  }
}

TEST(Combination, ChoosesTheMapWhereNothingIsInItsWay) {
  using config::CouplingScheme;
  const world::VoxelWorld cells(world::make_box(9).value(), "box:9");
  const auto sphere = world::SphereWorld::create({{}, 0.02, -0.02}).value();
  const config::WorldConfig plain;
  const config::CouplingConfig arm;
  EXPECT_EQ(arm.scheme, CouplingScheme::Auto) << "where nothing is said";
  EXPECT_EQ(choose_scheme(cells, plain, arm), CouplingScheme::Composite);
  EXPECT_EQ(choose_scheme(sphere, plain, arm), CouplingScheme::GhostPoint);
  config::WorldConfig simple;
  simple.constraint_model = config::ConstraintModel::Simple;
  EXPECT_EQ(choose_scheme(cells, simple, arm), CouplingScheme::GhostPoint);
  config::WorldConfig of_bone;
  of_bone.materials.emplace_back();
  EXPECT_EQ(choose_scheme(cells, of_bone, arm), CouplingScheme::GhostPoint);
  config::CouplingConfig waits;
  waits.mode = config::CouplingMode::LockStep;
  EXPECT_EQ(choose_scheme(cells, plain, waits), CouplingScheme::GhostPoint);
  for (const CouplingScheme said : {CouplingScheme::GhostPoint, CouplingScheme::Wave}) {
    config::CouplingConfig chosen;
    chosen.scheme = said;
    EXPECT_EQ(choose_scheme(cells, plain, chosen), said);
  }
}

TEST(Combination, RefusesABufferZoneThatReachesFurtherThanItCan) {
  const world::VoxelWorld fine(world::make_box(90).value(), "box:90");
  config::CouplingConfig arm;
  arm.scheme = config::CouplingScheme::BufferZone;
  EXPECT_TRUE(check_combination(fine, arm)) << "30 of 31 cells";
  arm.buffer_m = 0.032;
  const auto refused = check_combination(fine, arm);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::Unsupported);
  EXPECT_NE(refused.error().message.find("coupling.buffer_m: a buffer zone reaches 31 cells far"),
            std::string::npos)
      << refused.error().message;
}

TEST(PieceWorldOfAConfiguration, NeedsAClockAndRoomForItsPieces) {
  const sim::VirtualClock clock;
  config::WorldConfig said;
  said.source = "pieces";
  said.pieces = config::PiecesConfig{.cells = 32, .count = 3};
  const auto made = make_piece_world(said, &clock);
  ASSERT_TRUE(made);
  EXPECT_EQ(made->world->info().cells, (std::array<std::uint32_t, 3>{32, 32, 1}));
  EXPECT_DOUBLE_EQ(made->world->info().cell_m, 0.09 / 32);
  EXPECT_EQ(made->usb_board, nullptr);
  EXPECT_EQ(make_piece_world(said, nullptr).error().code, Errc::Unsupported);
  said.pieces->display_every = 7;
  EXPECT_TRUE(make_piece_world(said, &clock));
  said.pieces->board = config::PieceBoardKind::SimUsb;
  EXPECT_NE(make_piece_world(said, &clock)->usb_board, nullptr);
  said.pieces->board = config::PieceBoardKind::Usb;
  EXPECT_EQ(make_piece_world(said, &clock).error().code, Errc::Unsupported) << "without a bus";
  said.pieces->board = config::PieceBoardKind::Pci;
  EXPECT_EQ(make_piece_world(said, &clock).error().code, Errc::Unsupported) << "without a slot";
  said.pieces->board = config::PieceBoardKind::Sim;
  said.pieces->count = 63;
  EXPECT_EQ(make_piece_world(said, &clock).error().code, Errc::InvalidArgument);
}

TEST(Combination, ProgramsOf1999AreServedWhereTheirDatagramsSayWhatIsFelt) {
  const world::VoxelWorld with_cells(world::make_box(3).value(), "box:3");
  EXPECT_TRUE(can_serve_1999(with_cells));
  EXPECT_FALSE(can_serve_1999(*world::SphereWorld::create({{}, 0.02, -0.02})));
  const sim::VirtualClock clock;
  EXPECT_FALSE(can_serve_1999(*piece_world(clock).world));
}

TEST(Combination, TellsWhatAListenerDoesNotFeel) {
  config::WorldConfig said;
  said.name = "scan";
  EXPECT_FALSE(find_loss(said));
  said.materials.push_back({"bone", 1, 2, 1500, std::nullopt, std::nullopt});
  EXPECT_FALSE(find_loss(said)) << "an arm of this configuration feels them";
  said.listen = config::UdpEndpoint{"127.0.0.1", 5001};
  ASSERT_TRUE(find_loss(said));
  EXPECT_NE(find_loss(said)->find("world 'scan': arms that speak the datagrams of 1999 feel none"),
            std::string::npos);
  said.materials.clear();
  EXPECT_FALSE(find_loss(said));
}

}  // namespace
}  // namespace thimble::session
