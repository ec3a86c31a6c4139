#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <utility>

#include "daemon/world/cam/piece_board.hpp"
#include "drivers/cambus/board.hpp"
#include "drivers/cambus/pci_port.hpp"
#include "hal/device/wrapped_cam_board.hpp"
#include "sim/model/cam/sim_cam_board.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::world::cam::test {

// How programs of a board go wrong.
struct Accident {
  std::uint64_t at_program{0};  // counted from 1; 0: never
  bool is_done{false};          // the board has done all of it, and nobody knows
  // What a board makes of what it should have said; none: it says that.
  std::function<void(CamAnswer&)> lie{};
};

// A board over a simulated slot that a test can read, and that fails when it is told to: as one
// whose lists are lost. What it holds stays. Its bus is as fast as memory: a turn of a program is
// one of the clock here.
class WatchedBoard final : public WrappedCamBoard {
 public:
  WatchedBoard(sim::cam::SimCamBoard& slot, const Clock& clock, Accident& accident)
      : WrappedCamBoard(std::make_unique<cambus::Board>(
            cambus::PciPort::open(slot.open_window(), clock.now(), cambus::kMemoryTurn).value())),
        accident_(&accident) {}

  [[nodiscard]] Result<void> lay_out(const CamGeometry& geometry) override {
    has_failed_ = false;
    return WrappedCamBoard::lay_out(geometry);
  }
  [[nodiscard]] bool needs_lay_out() const noexcept override {
    return has_failed_ || WrappedCamBoard::needs_lay_out();
  }
  [[nodiscard]] Result<void> start(const CamSteps& steps, Duration at_most,
                                   MonotonicTime now) override {
    EXPECT_FALSE(has_failed_) << "it was not laid out anew";
    is_struck_ = ++programs_ == accident_->at_program;
    if (is_struck_ && !accident_->is_done) return WrappedCamBoard::start({}, at_most, now);
    return WrappedCamBoard::start(steps, at_most, now);
  }
  [[nodiscard]] Result<std::optional<CamAnswer>> poll(MonotonicTime now) override {
    auto answer = WrappedCamBoard::poll(now);
    if (answer && *answer && accident_->lie) accident_->lie(**answer);
    if (!is_struck_ || !answer || !*answer) return answer;
    has_failed_ = true;
    return fail(Errc::Timeout, "an accident");
  }
  [[nodiscard]] std::uint64_t programs() const noexcept { return programs_; }

  // All cells as they are; what moves is where it is seen.
  [[nodiscard]] CamCells read(const Clock& clock) {
    EXPECT_TRUE(
        WrappedCamBoard::start({cam_step::ReadCells{}}, std::chrono::seconds(1), clock.now()));
    auto answer = WrappedCamBoard::poll(clock.now());
    for (int i = 0; i < 100 && answer && !*answer; ++i) answer = WrappedCamBoard::poll(clock.now());
    if (!answer || !*answer) return {};
    return (*answer)->cells.at(0);
  }

 private:
  Accident* accident_;
  std::uint64_t programs_{0};
  bool is_struck_{false};
  bool has_failed_{false};
};

// Pieces on a simulated board that takes no time.
class PieceBench {
 public:
  PieceBench(const PieceSettings& settings, const PieceLayout& layout, const CamAxes& grasp,
             const sim::cam::TorusShape& shape)
      : slot_(clock_, {.shape = shape, .window_bytes = std::size_t{1} << 20, .is_paced = false}),
        board_(
            [this](MonotonicTime) -> Result<std::unique_ptr<CamBoard>> {
              auto board = std::make_unique<WatchedBoard>(slot_, clock_, accident_);
              watched_ = board.get();
              return board;
            },
            settings, layout, grasp) {
    pump();
  }

  // Until it is ready, whatever happens meanwhile.
  void pump() {
    for (int i = 0; i < 50; ++i) {
      board_.pump(clock_);
      if (board_.is_ready()) return;
      clock_.run_for(PieceBoard::kRetry);
    }
    ADD_FAILURE() << (board_.trouble() ? board_.trouble()->message : "it is never ready");
  }
  void strike(std::uint64_t programs_from_now, bool is_done) {
    accident_ = {watched_->programs() + programs_from_now, is_done, {}};
  }
  void lie(std::function<void(CamAnswer&)> how) { accident_.lie = std::move(how); }
  [[nodiscard]] PieceBoard& board() noexcept { return board_; }
  // Of the machine, so far.
  [[nodiscard]] std::uint64_t clocks() { return slot_.board().machine().now_clocks(); }
  [[nodiscard]] CamCells cells() { return watched_->read(clock_); }

 private:
  sim::VirtualClock clock_;
  sim::cam::SimCamBoard slot_;
  Accident accident_;
  WatchedBoard* watched_{nullptr};
  PieceBoard board_;
};

}  // namespace thimble::world::cam::test
