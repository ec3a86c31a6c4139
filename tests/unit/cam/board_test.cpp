#include "drivers/cambus/board.hpp"

#include <gtest/gtest.h>

#include "drivers/cambus/pci_port.hpp"
#include "sim/model/cam/sim_cam_board.hpp"
#include "sim/time/virtual_clock.hpp"

// Boards that fail while a program runs, and what is left of it; what programs do is in
// tests/contract/cam_board_contract.cpp.
namespace thimble::cambus {
namespace {

using sim::cam::SimCamBoard;
using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr CamGeometry kSpace{{3, 4, 0}, CamDivision::StripY};
constexpr Duration kPatience = milliseconds(100);

std::shared_ptr<const CamTable> identity() {
  CamTable table(kCamTableEntries);
  for (std::size_t n = 0; n < table.size(); ++n) table[n] = static_cast<std::uint16_t>(n);
  return std::make_shared<const CamTable>(std::move(table));
}

std::shared_ptr<const CamCells> numbered_cells() {
  CamCells cells(kSpace.cells());
  for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = static_cast<std::uint16_t>(77 * i + 1);
  return std::make_shared<const CamCells>(std::move(cells));
}

// A port that, like one over USB, brings what was read later than it is asked for.
class LatePort final : public BoardPort {
 public:
  LatePort(std::unique_ptr<BoardPort> port, int late) : port_(std::move(port)), late_(late) {}
  [[nodiscard]] const BoardFacts& facts() const noexcept override { return port_->facts(); }
  IoStatus poll(MonotonicTime now, BoardStatus& out) override { return port_->poll(now, out); }
  IoStatus confirm(MonotonicTime now) override { return port_->confirm(now); }
  IoStatus ring(const std::array<std::uint32_t, page::kHostRegisters>& registers,
                std::uint32_t meant) override {
    return port_->ring(registers, meant);
  }
  [[nodiscard]] bool is_taken(const BoardStatus& status) const noexcept override {
    return port_->is_taken(status);
  }
  IoStatus put(std::uint32_t offset, std::span<const std::uint8_t> bytes) override {
    return is_full_ ? IoStatus::Backlogged : port_->put(offset, bytes);
  }
  IoStatus get(std::uint32_t offset, std::span<std::uint8_t> bytes) override {
    if (asked_++ % late_ != late_ - 1) return IoStatus::NoData;
    return port_->get(offset, bytes);
  }
  void drop_unsent() override { port_->drop_unsent(); }
  [[nodiscard]] Gone why_gone() const noexcept override { return port_->why_gone(); }
  void be_full(bool is_full) noexcept { is_full_ = is_full; }

 private:
  std::unique_ptr<BoardPort> port_;
  int late_;
  int asked_{0};
  bool is_full_{false};
};

// Counts what moves over the bus: a word read is a microsecond of who waits for it.
class CountedWindow final : public bus::MemoryWindow {
 public:
  struct Words {
    std::size_t read{0};
    std::size_t written{0};
  };
  CountedWindow(std::unique_ptr<bus::MemoryWindow> window, Words& words)
      : window_(std::move(window)), words_(&words) {}
  [[nodiscard]] std::size_t bytes() const noexcept override { return window_->bytes(); }
  IoStatus read(std::uint32_t offset, std::uint32_t& out) noexcept override {
    ++words_->read;
    return window_->read(offset, out);
  }
  IoStatus write(std::uint32_t offset, std::uint32_t word) noexcept override {
    ++words_->written;
    return window_->write(offset, word);
  }
  IoStatus read_block(std::uint32_t offset, std::span<std::uint32_t> out) noexcept override {
    words_->read += out.size();
    return window_->read_block(offset, out);
  }
  IoStatus write_block(std::uint32_t offset,
                       std::span<const std::uint32_t> words) noexcept override {
    words_->written += words.size();
    return window_->write_block(offset, words);
  }
  void barrier() noexcept override { window_->barrier(); }

 private:
  std::unique_ptr<bus::MemoryWindow> window_;
  Words* words_;
};

class BoardTest : public testing::Test {
 protected:
  std::unique_ptr<PciPort> port() {
    return PciPort::open(slot_.open_window(), clock_.now()).value();
  }
  static Result<CamAnswer> wait(Board& board, sim::VirtualClock& clock) {
    while (true) {
      auto answer = board.poll(clock.now());
      if (!answer) return tl::unexpected(answer.error());
      if (*answer) return **std::move(answer);
      clock.run_for(microseconds(20));
    }
  }
  Result<CamAnswer> play(const CamSteps& steps, Duration at_most = kPatience) {
    const auto started = board_.start(steps, at_most, clock_.now());
    if (!started) return tl::unexpected(started.error());
    return wait(board_, clock_);
  }
  void expect_failed(const Result<CamAnswer>& answer, Errc code) {
    ASSERT_FALSE(answer);
    EXPECT_EQ(answer.error().code, code) << answer.error().message;
    EXPECT_FALSE(board_.is_running());
    EXPECT_TRUE(board_.needs_lay_out());
    EXPECT_EQ(play({}).error().code, Errc::InvalidArgument) << "it has to be laid out again";
  }
  // Laid out anew, it has the cells that it had, and moves them.
  void expect_works_with(const CamCells& cells) {
    ASSERT_TRUE(board_.lay_out(kSpace));
    const auto answer =
        play({cam_step::LoadTable{identity()},
              cam_step::Run{{.is_scan = false, .swaps_tables = true}}, cam_step::ReadCells{},
              cam_step::Kick{{{0xffff, {0, 1, 0}}}}, cam_step::Run{}, cam_step::ReadCells{}});
    ASSERT_TRUE(answer) << answer.error().message;
    ASSERT_EQ(answer->cells.size(), 2U);
    EXPECT_EQ(answer->cells[0], cells);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      EXPECT_EQ(answer->cells[1][(i + 8) % cells.size()], cells[i]);
    }
  }
  void SetUp() override {
    ASSERT_TRUE(board_.lay_out(kSpace));
    ASSERT_TRUE(play({cam_step::LoadTable{identity()},
                      cam_step::Run{{.is_scan = false, .swaps_tables = true}},
                      cam_step::WriteCells{cells_}}));
  }

  sim::VirtualClock clock_;
  SimCamBoard slot_{clock_, {.shape = {{2, 1, 1}, 6}, .window_bytes = std::size_t{1} << 20}};
  Board board_{port()};
  std::shared_ptr<const CamCells> cells_ = numbered_cells();
};

TEST_F(BoardTest, OneThatDoesNotFinishInTimeIsGivenUpAndWorksAgain) {
  const auto scans = [] {
    CamSteps steps;
    for (int i = 0; i < 100; ++i) steps.emplace_back(cam_step::Run{});
    return steps;
  }();
  const MonotonicTime before = clock_.now();
  expect_failed(play(scans, microseconds(100)), Errc::Timeout);
  EXPECT_LE(clock_.now() - before, microseconds(120));
  expect_works_with(*cells_);
  EXPECT_EQ(board_.counters(), (CamBoardCounters{.started = 3, .done = 2, .failed = 1}));
}

TEST_F(BoardTest, OneThatFreezesIsGoneByItsBeat) {
  ASSERT_TRUE(board_.start({cam_step::Run{}}, std::chrono::seconds(10), clock_.now()));
  slot_.freeze();
  const auto answer = wait(board_, clock_);
  expect_failed(answer, Errc::Disconnected);
  EXPECT_NE(answer.error().message.find("beat"), std::string::npos) << answer.error().message;
}

TEST_F(BoardTest, OneThatLosesItsPowerIsAnotherOne) {
  ASSERT_TRUE(board_.start({cam_step::Run{}}, kPatience, clock_.now()));
  slot_.power_cycle();
  expect_failed(wait(board_, clock_), Errc::Disconnected);
  Board other(port());
  EXPECT_TRUE(other.needs_lay_out());
  ASSERT_TRUE(other.lay_out(kSpace));
  ASSERT_TRUE(other.start({cam_step::ReadCells{}}, kPatience, clock_.now()));
  const auto answer = wait(other, clock_);
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(answer->cells.at(0), CamCells(kSpace.cells())) << "its memory is lost";
}

// Somebody else, a tool or a second driver, at the same registers.
class ResetByAnother : public BoardTest {
 protected:
  void reset() {
    std::array<std::uint32_t, page::kHostRegisters> registers{};
    registers[1] = page::kResetInterface;
    const auto window = slot_.open_window();
    std::uint32_t rung = 0;
    ASSERT_EQ(window->read(page::kDoorbell, rung), IoStatus::Ok);
    ASSERT_EQ(window->write_block(page::kWritten, registers), IoStatus::Ok);
    ASSERT_EQ(window->write(page::kMeant, 2), IoStatus::Ok);
    ASSERT_EQ(window->write(page::kDoorbell, rung + 1), IoStatus::Ok);
  }
};

TEST_F(ResetByAnother, UnderWayIsSeenAndMended) {
  ASSERT_TRUE(board_.start({cam_step::Run{}, cam_step::Run{}}, kPatience, clock_.now()));
  ASSERT_FALSE(board_.poll(clock_.now()).value());
  clock_.run_for(microseconds(2));
  reset();
  const auto answer = wait(board_, clock_);
  ASSERT_FALSE(answer);
  EXPECT_TRUE(board_.needs_lay_out());
  expect_works_with(*cells_);
}

TEST_F(BoardTest, AKickLongerThanAModuleIsRefusedWhereTheSpaceIsDivided) {
  const auto kick = [&](int x, int y) {
    return play({cam_step::Kick{{{1, {x, y, 0}}}}, cam_step::Run{}});
  };
  EXPECT_EQ(kick(0, 9).error().code, Errc::InvalidArgument);
  EXPECT_EQ(kick(0, -9).error().code, Errc::InvalidArgument);
  EXPECT_TRUE(kick(1000, 8)) << "the other axis wraps within a module";
}

TEST_F(BoardTest, WhatDoesNotFitTheWindowIsRefused) {
  CamSteps tables(9, cam_step::LoadTable{identity()});  // 128 KiB each
  EXPECT_EQ(play(tables).error().code, Errc::TooLarge);
  EXPECT_FALSE(board_.needs_lay_out());
  EXPECT_TRUE(play({cam_step::Run{}}));
}

TEST_F(BoardTest, WhatAPortBringsLateIsWaitedForAndNoLonger) {
  auto late = std::make_unique<LatePort>(port(), 5);
  LatePort* const slow = late.get();
  Board other(std::move(late));
  ASSERT_TRUE(other.lay_out(kSpace));
  slow->be_full(true);
  ASSERT_TRUE(other.start({cam_step::ReadCells{}}, kPatience, clock_.now()));
  for (int i = 0; i < 20; ++i) {
    EXPECT_FALSE(other.poll(clock_.now()).value()) << "its list has no room yet";
    clock_.run_for(microseconds(20));
  }
  slow->be_full(false);
  const auto answer = wait(other, clock_);
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(answer->cells.at(0), *cells_);

  Board never(std::make_unique<LatePort>(port(), 1'000'000'000));
  ASSERT_TRUE(never.lay_out(kSpace));
  const MonotonicTime before = clock_.now();
  ASSERT_TRUE(never.start({cam_step::ReadCounts{}}, kPatience, clock_.now()));
  EXPECT_EQ(wait(never, clock_).error().code, Errc::Timeout);
  EXPECT_LE(clock_.now() - before, kPatience + microseconds(20));
  EXPECT_TRUE(never.needs_lay_out());
}

// The thread that moves them serves all links: whatever a program writes and reads, half a
// millisecond at a time.
TEST(ABoardOverPci, MovesAFewWordsATurn) {
  constexpr CamGeometry kLarge{{7, 7, 2}, CamDivision::StripY};
  constexpr std::size_t kPage = 150;  // of looks at it, and doorbells
  sim::VirtualClock clock;
  SimCamBoard slot(
      clock, {.shape = {{2, 2, 2}, 13}, .window_bytes = std::size_t{1} << 21, .is_paced = false});
  CountedWindow::Words words;
  auto window = std::make_unique<CountedWindow>(slot.open_window(), words);
  Board sut(PciPort::open(std::move(window), clock.now()).value());
  ASSERT_TRUE(sut.lay_out(kLarge));
  CamCells cells(kLarge.cells());
  for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = static_cast<std::uint16_t>(77 * i + 1);
  CamSteps steps{cam_step::LoadTable{identity()},
                 cam_step::Run{{.is_scan = false, .swaps_tables = true}},
                 cam_step::WriteCells{std::make_shared<const CamCells>(cells)},
                 cam_step::ReadCells{}, cam_step::Count{CamEvents::Site}};
  for (int i = 0; i < 30; ++i) {
    steps.emplace_back(cam_step::Run{{.takes_counts = true}});
    steps.emplace_back(cam_step::ReadCounts{});
  }
  ASSERT_TRUE(sut.start(steps, kPatience, clock.now()));
  std::optional<CamAnswer> answer;
  std::size_t turns = 0;
  while (!answer) {
    const CountedWindow::Words before = words;
    auto said = sut.poll(clock.now());
    ASSERT_TRUE(said) << said.error().message;
    answer = *std::move(said);
    ASSERT_LE(words.read - before.read, kBusTurn.reads + kPage) << "turn " << turns;
    ASSERT_LE(words.written - before.written, kBusTurn.writes + kPage) << "turn " << turns;
    clock.run_for(microseconds(20));
    ++turns;
  }
  EXPECT_EQ(answer->cells.at(0), cells);
  EXPECT_EQ(answer->counts.size(), 30U);
  EXPECT_GT(turns, cells.size() / 2 / kBusTurn.reads);
}

}  // namespace
}  // namespace thimble::cambus
