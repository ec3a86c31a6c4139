#include <gtest/gtest.h>

#include <memory>
#include <optional>

#include "daemon/world/cam/piece_board.hpp"
#include "sim/time/virtual_clock.hpp"

// Boards that are there, and of no use.
namespace thimble::world::cam {
namespace {

constexpr CamGeometry kTiny{{3, 3, 0}, CamDivision::Mesh};

// What a board answers; shared by all that are opened.
struct Manners {
  std::optional<Error> lay_out;
  std::optional<Error> start;
  std::optional<Error> poll;  // nothing: its program is over
  int lay_outs{0};
};

class UnfitBoard final : public CamBoard {
 public:
  explicit UnfitBoard(Manners& manners) : manners_(manners) {}
  [[nodiscard]] const CamBoardInfo& info() const noexcept override { return info_; }
  [[nodiscard]] Result<void> lay_out(const CamGeometry& /*geometry*/) override {
    ++manners_.lay_outs;
    if (manners_.lay_out) return tl::unexpected(*manners_.lay_out);
    return {};
  }
  [[nodiscard]] bool needs_lay_out() const noexcept override { return true; }
  [[nodiscard]] Result<void> start(const CamSteps& /*steps*/, Duration /*at_most*/,
                                   MonotonicTime /*now*/) override {
    if (manners_.start) return tl::unexpected(*manners_.start);
    is_running_ = true;
    return {};
  }
  [[nodiscard]] Result<std::optional<CamAnswer>> poll(MonotonicTime /*now*/) override {
    is_running_ = false;
    if (manners_.poll) return tl::unexpected(*manners_.poll);
    return CamAnswer{std::vector<CamCounts>(8), {CamCells(kTiny.cells())}};  // nothing there
  }
  [[nodiscard]] bool is_running() const noexcept override { return is_running_; }
  [[nodiscard]] const CamBoardCounters& counters() const noexcept override { return counters_; }

 private:
  Manners& manners_;
  CamBoardInfo info_{1, 6, 25'000'000};
  CamBoardCounters counters_;
  bool is_running_{false};
};

class AnUnfitBoard : public testing::Test {
 protected:
  void try_again() {
    clock_.run_for(PieceBoard::kRetry);
    sut_.pump(clock_);
  }

  sim::VirtualClock clock_;
  Manners manners_;
  int opened_{0};
  bool is_looked_for_{false};
  PieceBoard sut_{[this](MonotonicTime) -> Result<std::unique_ptr<CamBoard>> {
                    if (is_looked_for_) return fail(Errc::Busy, "looked for");
                    ++opened_;
                    return std::make_unique<UnfitBoard>(manners_);
                  },
                  {.space = kTiny},
                  PieceLayout(kTiny.cells()),
                  {4, 4, 0}};
};

TEST_F(AnUnfitBoard, IsOpenedAnewAfterSoManyTimeoutsInARow) {
  manners_.poll = Error{Errc::Timeout, "too slow"};
  for (int round = 1; round <= 3; ++round) {
    for (int i = 1; i < PieceBoard::kMostTimeouts; ++i) {
      try_again();
      EXPECT_EQ(opened_, round);
      EXPECT_EQ(sut_.trouble().value().message, "too slow");
    }
    try_again();
    EXPECT_EQ(opened_, round) << "that was the last time";
    EXPECT_EQ(sut_.trouble().value().message,
              "too slow; that was time 3 in a row, the board is opened anew");
  }
}

TEST_F(AnUnfitBoard, ThatIsTooSmallIsClosedAndThereMayBeAnother) {
  const Error too_small{Errc::InvalidArgument, "too small"};
  const Error no_room{Errc::TooLarge, "no room"};
  for (int round = 1; round <= 4; ++round) {
    manners_.lay_out = round % 2 == 0 ? std::optional(too_small) : std::nullopt;
    manners_.start = no_room;
    try_again();
    EXPECT_EQ(opened_, round);
    EXPECT_EQ(sut_.trouble().value(), round % 2 == 0 ? too_small : no_room);
  }
  manners_ = {};
  try_again();
  EXPECT_EQ(opened_, 5);
  EXPECT_FALSE(sut_.trouble());
}

TEST_F(AnUnfitBoard, WhileAnotherIsLookedForItIsSaidWhatWasWrong) {
  manners_.lay_out = Error{Errc::InvalidArgument, "too small"};
  try_again();
  is_looked_for_ = true;
  try_again();
  EXPECT_EQ(sut_.trouble(), manners_.lay_out);
}

TEST_F(AnUnfitBoard, ThatFailsOtherwiseIsKeptAndLaidOutAgain) {
  for (int i = 1; i <= 5; ++i) {
    manners_.poll = Error{Errc::System, "parity"};
    try_again();
    EXPECT_EQ(manners_.lay_outs, i);
  }
  EXPECT_EQ(opened_, 1);
}

TEST_F(AnUnfitBoard, ThatWorksMeanwhileIsKept) {
  for (int i = 0; i < 4 * PieceBoard::kMostTimeouts; ++i) {
    manners_.poll = Error{Errc::Timeout, "too slow"};
    if (sut_.is_ready()) sut_.move({1, 0, 0});
    if (i % PieceBoard::kMostTimeouts == 0) manners_.poll.reset();
    try_again();
  }
  EXPECT_GT(sut_.counters().failures, 6U);
  EXPECT_EQ(opened_, 1);
}

// What is felt goes before what is seen.
TEST_F(AnUnfitBoard, ThatFailsAtAPictureIsDarkUntilItIsOpenedAnew) {
  try_again();
  ASSERT_TRUE(sut_.is_ready());
  manners_.poll = Error{Errc::System, "no pulses"};
  sut_.show();
  sut_.pump(clock_);
  EXPECT_TRUE(sut_.trouble());
  manners_.poll.reset();
  for (int i = 0; i < 3; ++i) try_again();
  EXPECT_FALSE(sut_.trouble());
  ASSERT_TRUE(sut_.why_dark());
  EXPECT_EQ(sut_.why_dark()->message, "nothing is shown on the board's monitor: no pulses");
  EXPECT_EQ(sut_.counters().pictures, 0U);
  manners_.poll = Error{Errc::Disconnected, "unplugged"};
  sut_.act(PieceAction::Look, {});
  sut_.pump(clock_);
  manners_.poll.reset();
  for (int i = 0; i < 3; ++i) try_again();
  EXPECT_EQ(opened_, 2);
  EXPECT_FALSE(sut_.why_dark());
}

}  // namespace
}  // namespace thimble::world::cam
