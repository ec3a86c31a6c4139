#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <utility>

#include "daemon/world/cam/piece_world.hpp"
#include "drivers/cambus/board.hpp"
#include "drivers/cambus/pci_port.hpp"
#include "sim/model/cam/sim_cam_board.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::world::cam::test {

inline constexpr CamGeometry kSpace{{5, 5, 0}, CamDivision::StripY};
inline constexpr double kCell_m = 0.09 / 32;

// A square of 8 cells a side, left of the middle of 32.
inline PieceLayout one_square() {
  PieceLayout layout(kSpace.cells());
  for (int y = 12; y < 20; ++y) {
    for (int x = 4; x < 12; ++x) layout[index_of(kSpace, {x, y, 0})] = 7;
  }
  return layout;
}

// And another, half as high on the right.
inline PieceLayout two_squares() {
  PieceLayout layout = one_square();
  for (int y = 16; y < 24; ++y) {
    for (int x = 20; x < 28; ++x) layout[index_of(kSpace, {x, y, 0})] = 9;
  }
  return layout;
}

// The middle of a cell.
inline Position3 at(int x, int y, double z_m = 0) {
  return {(x - 15.5) * kCell_m, (y - 15.5) * kCell_m, z_m};
}

// A hand in a world on a board that takes its time: 25 MHz, two modules.
class HandInWorld : public testing::Test {
 protected:
  Result<std::unique_ptr<CamBoard>> open(MonotonicTime now) {
    if (!slot_) return fail(Errc::NotFound, "no board is plugged in");
    auto port = cambus::PciPort::open(slot_->open_window(), now);
    if (!port) return tl::unexpected(port.error());
    return std::make_unique<cambus::Board>(*std::move(port));
  }
  void plug_in() {
    slot_ = std::make_unique<sim::cam::SimCamBoard>(
        clock_, sim::cam::BoardOptions{.shape = {{2, 1, 1}, 9}, .window_bytes = 1 << 20});
  }
  // Its machine does nothing for so long, and its page beats on; what it holds stays.
  void hang(Duration time) {
    const double clocks = seconds(time) * 25e6;
    slot_->board().machine().hang_for(static_cast<std::uint64_t>(clocks));
  }
  ProbeMotion hold(Position3 hand, Duration time = std::chrono::milliseconds(20)) {
    ProbeMotion motion;
    for (const MonotonicTime end = clock_.now() + time; clock_.now() < end;) {
      clock_.run_for(std::chrono::milliseconds(1));
      motion = world_->move_probe(probe_, hand, std::chrono::milliseconds(1));
    }
    return motion;
  }
  std::optional<PieceOutcome> act(PieceAction action, Position3 hand) {
    const auto number = world_->submit(action);
    if (!number) return std::nullopt;
    hold(hand, std::chrono::milliseconds(50));
    const auto finished = world_->take_finished();
    if (finished.size() != 1 || finished[0].number != *number) return std::nullopt;
    return finished[0].outcome;
  }
  void SetUp() override { begin({.space = kSpace}); }
  void begin(const PieceSettings& settings) {
    begin({.pieces = settings, .source = "pieces"}, one_square());
  }
  void begin(const PieceWorldSettings& settings, PieceLayout layout) {
    plug_in();
    auto world = PieceWorld::create(
        settings, [this](MonotonicTime now) { return open(now); }, std::move(layout), clock_);
    ASSERT_TRUE(world) << world.error().message;
    world_ = *std::move(world);
    probe_ = world_->add_probe(at(16, 16)).value();
  }

  sim::VirtualClock clock_;
  std::unique_ptr<sim::cam::SimCamBoard> slot_;
  std::unique_ptr<PieceWorld> world_;
  ProbeId probe_;
};

}  // namespace thimble::world::cam::test
