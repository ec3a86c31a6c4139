#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <random>
#include <utility>

#include "daemon/coupling/buffer_zone_arm.hpp"
#include "daemon/coupling/buffer_zone_world.hpp"
#include "daemon/coupling/wall_penalty.hpp"
#include "daemon/world/cam/piece_world.hpp"
#include "drivers/cambus/board.hpp"
#include "drivers/cambus/pci_port.hpp"
#include "linked_loop.hpp"
#include "sim/model/cam/sim_cam_board.hpp"
#include "sim/time/virtual_clock.hpp"
#include "zone_hand.hpp"

namespace thimble::coupling {
namespace {

using testing::between;
using testing::LinkedLoop;
using testing::ZoneHand;
using world::cam::PieceLayout;
using world::cam::PieceWorld;

constexpr double kWorkspace_m = 0.09;
const ToolProperties kTool = BufferZoneSettings{}.tool;

// Cells that the grasp point is free in, both ends included; the third axis of a plane is free.
struct Room {
  CamGeometry space;
  CamAxes first{};
  CamAxes last{};
  [[nodiscard]] CamAxes middle() const {
    return {(first[0] + last[0]) / 2, (first[1] + last[1]) / 2, (first[2] + last[2]) / 2};
  }
  [[nodiscard]] double cell_m() const {
    const CamAxes size = cells();
    return kWorkspace_m / *std::max_element(size.begin(), size.end());
  }
  [[nodiscard]] double face_m(std::size_t axis, int index) const {
    return (2 * index - cells()[axis]) * (0.5 * cell_m());
  }
  [[nodiscard]] CamAxes cells() const { return world::cam::cells_along(space); }
};

Room room_at_random(std::mt19937_64& random, const CamGeometry& space, bool may_reach_the_edge) {
  Room room{.space = space};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int length = room.cells()[axis];
    if (length == 1) continue;
    const int least = may_reach_the_edge ? 0 : 1;
    room.first[axis] = least + static_cast<int>(random() % 3);
    room.last[axis] = length - 1 - least - static_cast<int>(random() % 3);
  }
  return room;
}

bool is_within(const CamAxes& at, const CamAxes& first, const CamAxes& last) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (at[axis] < first[axis] || at[axis] > last[axis]) return false;
  }
  return true;
}

// A piece all around the room, and where there is a second one, it lies around its middle, a cell
// further each way.
PieceLayout layout_of(const Room& room, bool has_piece) {
  PieceLayout layout(room.space.cells());
  CamAxes low = room.middle();
  CamAxes high = room.middle();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (room.cells()[axis] == 1) continue;
    --low[axis];
    ++high[axis];
  }
  CamAxes at{};
  for (at[2] = 0; at[2] < room.cells()[2]; ++at[2]) {
    for (at[1] = 0; at[1] < room.cells()[1]; ++at[1]) {
      for (at[0] = 0; at[0] < room.cells()[0]; ++at[0]) {
        std::uint8_t& there = layout[world::cam::index_of(room.space, at)];
        if (!is_within(at, room.first, room.last)) there = 7;
        if (has_piece && is_within(at, low, high)) there = 3;
      }
    }
  }
  return layout;
}

// What is felt without any delay.
struct Undelayed {
  explicit Undelayed(const Room& of) : room(of) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (room.cells()[axis] == 1) continue;
      ConstraintPlane low{.offset_m = -room.face_m(axis, room.first[axis])};
      low.normal[axis] = -1;
      ConstraintPlane high{.offset_m = room.face_m(axis, room.last[axis] + 1)};
      high.normal[axis] = 1;
      planes.push_back(low);
      planes.push_back(high);
    }
  }
  [[nodiscard]] Position3 ghost(Position3 tip) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (room.cells()[axis] == 1) continue;
      tip[axis] = std::clamp(tip[axis], room.face_m(axis, room.first[axis]),
                             room.face_m(axis, room.last[axis] + 1));
    }
    return tip;
  }
  Room room;
  PlaneList planes;
};

// Pieces on a board that takes its time: 25 MHz, four modules.
class Pieces {
 public:
  Pieces(const Room& room, PieceLayout layout)
      : slot_(clock_, {.shape = {{2, 2, 1}, log2_sites(room.space)}, .window_bytes = 1 << 21}),
        world_(PieceWorld::create(
                   {.pieces = {.space = room.space, .search = world::cam::SearchKind::BoundedSweep},
                    .workspace_m = kWorkspace_m,
                    .source = "pieces"},
                   [this](MonotonicTime now) { return open(now); }, std::move(layout), clock_)
                   .value()) {}
  void run_for(Duration time) { clock_.run_for(time); }
  [[nodiscard]] PieceWorld& world() { return *world_; }

 private:
  static int log2_sites(const CamGeometry& space) {
    return space.log2_cells[0] + space.log2_cells[1] + space.log2_cells[2] - 2;
  }
  Result<std::unique_ptr<CamBoard>> open(MonotonicTime now) {
    auto port = cambus::PciPort::open(slot_.open_window(), now, cambus::kMemoryTurn);
    if (!port) return tl::unexpected(port.error());
    return std::make_unique<cambus::Board>(*std::move(port));
  }

  sim::VirtualClock clock_;
  sim::cam::SimCamBoard slot_;
  std::unique_ptr<PieceWorld> world_;
};

struct Course {
  Room room;
  bool has_piece{false};
  double delay_s{0};
  double buffer_m{0};
  link::ImpairmentSettings link{};
};

constexpr double kMost_m_per_s = 0.25;
constexpr Duration kTick = std::chrono::milliseconds(1);

struct Compared {
  int ticks_felt{0};
  int ticks_that_differ{0};
};

// The same hand on the scheme and without any delay.
Compared compare(const Course& course, std::uint64_t seed) {
  Pieces pieces(course.room, layout_of(course.room, course.has_piece));
  BufferZoneArm arm;
  BufferZoneWorld world(pieces.world(), 1,
                        {.buffer_m = course.buffer_m, .names = ZoneNames::Faces});
  LinkedLoop loop(arm, world, kTick, course.link);
  Room room = course.room;
  Position3 start;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (room.cells()[axis] == 1) continue;
    start[axis] = room.face_m(axis, room.middle()[axis]) + 0.5 * room.cell_m();
    if (!course.has_piece) continue;
    ++room.first[axis];
    --room.last[axis];
  }
  const Undelayed undelayed(room);
  for (int i = 0; i < 1000; ++i) {
    pieces.run_for(kTick);
    static_cast<void>(loop.tick(start, {}));
    if (course.has_piece && i == 500) {
      static_cast<void>(pieces.world().submit(world::cam::PieceAction::Select));
    }
  }
  EXPECT_EQ(pieces.world().board().state().held, course.has_piece ? 3 : 0);
  ZoneHand hand(seed, start, kMost_m_per_s);
  Compared out;
  for (int i = 0; i < 2500; ++i) {
    pieces.run_for(kTick);
    hand.move(undelayed.ghost(hand.at()), kTick);
    const Force3 expected = wall_penalty(undelayed.planes, kTool, hand.at(), hand.velocity());
    const Force3 felt = loop.tick(hand.at(), hand.velocity()).force;
    if (expected != Force3{}) ++out.ticks_felt;
    if (felt != expected) ++out.ticks_that_differ;
  }
  EXPECT_EQ(pieces.world().board().counters().failures, 0U);
  EXPECT_GT(pieces.world().board().counters().zones, 20U);
  return out;
}

constexpr std::array<CamGeometry, 2> kSpaces{
    {{{5, 5, 0}, CamDivision::StripY}, {{4, 4, 4}, CamDivision::StripY}}};

// Until the board has moved there and looked around; of these boards.
constexpr double kBoard_s = 0.010;

// teleop.md 2(d), of the cells of a board.
TEST(BufferZoneOfPieces, IsFeltAsWithoutDelayBitForBitInRoomsWithAPieceAndWithout) {
  std::mt19937_64 random(614);
  int felt = 0;
  for (std::uint64_t run = 0; run < 8; ++run) {
    const bool has_piece = run % 4 >= 2;
    Course course{.room = room_at_random(random, kSpaces[run % 2], !has_piece),
                  .has_piece = has_piece,
                  .delay_s = between(random, 0, 0.06)};
    course.link = {.delay_s = course.delay_s,
                   .jitter_s = course.delay_s / 4,
                   .loss = 0.05,
                   .duplicate = 0.02,
                   .reorder = 0.02,
                   .seed = run};
    course.buffer_m = kMost_m_per_s * (1.5 * course.delay_s + kBoard_s + 10 * seconds(kTick));
    const Compared found = compare(course, run);
    EXPECT_EQ(found.ticks_that_differ, 0) << run;
    felt += found.ticks_felt;
  }
  EXPECT_GT(felt, 4'000);
}

TEST(BufferZoneOfPieces, OneThatIsTooSmallForItsDelayIsFeltLate) {
  std::mt19937_64 random(615);
  Course course{.room = room_at_random(random, kSpaces[0], true), .delay_s = 0.1};
  course.link = {.delay_s = course.delay_s};
  course.buffer_m = 0.001;
  EXPECT_GT(compare(course, 1).ticks_that_differ, 0);
}

TEST(BufferZoneOfPieces, TheCellsOfABoardAreNotNamed) {
  std::mt19937_64 random(616);
  const Room room = room_at_random(random, kSpaces[0], true);
  Pieces pieces(room, layout_of(room, false));
  BufferZoneWorld world(pieces.world(), 1, {.names = ZoneNames::Cells});
  const auto opened = world.open({});
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, Errc::Unsupported);
}

}  // namespace
}  // namespace thimble::coupling
