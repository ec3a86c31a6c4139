#include "lab/compare/stage.hpp"

#include <cmath>
#include <utility>

namespace thimble::lab {
namespace {

constexpr std::uint32_t kCells = 32;
constexpr std::int32_t kHalf = kCells / 2;
constexpr std::int32_t kFirstOfWall = kHalf + 5;  // 15 mm from the middle
// Ours: two of the longest round trips, and what rises after an outage (100 ms) thrice.
constexpr double kRest_s = 1.3;

}  // namespace

Stage::Stage(const StageSettings& settings, std::unique_ptr<world::VoxelWorld> world) noexcept
    : settings_(settings), world_(std::move(world)) {}

Result<std::unique_ptr<Stage>> Stage::create(const CouplingCase& of, const StageSettings& settings,
                                             Position3 start) {
  auto grid = world::VoxelGrid::create({kCells, kCells, kCells}, kStageCell_m);
  if (!grid) return tl::unexpected(grid.error());
  for (std::int32_t z = 0; z < static_cast<std::int32_t>(kCells); ++z) {
    for (std::int32_t y = 0; y < kHalf; ++y) {
      (void)grid->set_row({kFirstOfWall, y, z}, static_cast<std::int32_t>(kCells), true);
    }
  }
  auto world = std::make_unique<world::VoxelWorld>(*std::move(grid), "the lab's wall");
  std::unique_ptr<Stage> stage(new Stage(settings, std::move(world)));
  CouplingCase as = of;
  as.settings.ghost_point.cell_m = kStageCell_m;
  auto loop = make_trial(as, *stage->world_,
                         {.impairment = {.delay_s = settings.delay_s,
                                         .jitter_s = settings.jitter_s,
                                         .loss = settings.loss,
                                         .seed = settings.seed}});
  if (!loop) return tl::unexpected(loop.error());
  stage->loop_ = *std::move(loop);
  stage->rest(start);
  return stage;
}

void Stage::rest(Position3 start) {
  const auto ticks = static_cast<int>(kRest_s / seconds(loop_->dt()));
  for (int i = 0; i < ticks; ++i) (void)loop_->tick(start, {});
  began_ = loop_->now();
  packets_before_ = packets();
  bytes_before_ = loop_->bytes();
}

std::uint64_t Stage::packets() const {
  const link::LinkCounters counters = loop_->status().counters;
  return counters.sent + counters.received;
}

double Stage::packets_per_s() const {
  return static_cast<double>(packets() - packets_before_) / now_s_;
}

double Stage::bytes_per_s() const {
  return static_cast<double>(loop_->bytes() - bytes_before_) / now_s_;
}

const Felt& Stage::tick(Position3 tip, Velocity3 velocity) {
  const double in_cycle_s = std::fmod(now_s_, kOutageEvery_s);
  const bool is_out = settings_.has_outages && in_cycle_s >= kOutageEvery_s - kOutage_s;
  loop_->set_network(!is_out && now_s_ >= silent_until_s_);
  if (settings_.moves) move_wall();
  const coupling::ArmOutput output = loop_->tick(tip, velocity);
  now_s_ = seconds(loop_->now() - began_);
  history_.push_back({.now_s = now_s_,
                      .tip = tip,
                      .velocity = velocity,
                      .force = output.force,
                      .offset = output.offset,
                      .is_in_contact = output.is_in_contact});
  return history_.back();
}

void Stage::move_wall() {
  const bool is_wanted = std::fmod(now_s_, 2 * kMoveEvery_s) >= kMoveEvery_s;
  if (std::exchange(is_forward_, is_wanted) == is_wanted) return;
  for (std::int32_t z = 0; z < static_cast<std::int32_t>(kCells); ++z) {
    for (std::int32_t y = 0; y < kHalf; ++y) {
      world_->set_cell({kFirstOfWall - 1, y, z}, is_wanted);
    }
  }
}

}  // namespace thimble::lab
