#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "drivers/cambus/board_port.hpp"
#include "drivers/cambus/cam_program.hpp"
#include "drivers/cambus/list_player.hpp"
#include "hal/device/cam_board.hpp"

namespace thimble::cambus {

// A board behind a port: programs become step lists, one each. Ownership: owns the port.
// For thread and errors see CamBoard.
class Board final : public CamBoard {
 public:
  explicit Board(std::unique_ptr<BoardPort> port);

  [[nodiscard]] const CamBoardInfo& info() const noexcept override { return info_; }
  [[nodiscard]] Result<void> lay_out(const CamGeometry& geometry) override;
  [[nodiscard]] bool needs_lay_out() const noexcept override { return !space_; }
  [[nodiscard]] Result<void> start(const CamSteps& steps, Duration at_most,
                                   MonotonicTime now) override;
  [[nodiscard]] Result<std::optional<CamAnswer>> poll(MonotonicTime now) override;
  [[nodiscard]] bool is_running() const noexcept override { return is_running_; }
  [[nodiscard]] const CamBoardCounters& counters() const noexcept override { return counters_; }

  // What became of the lists, and why a board is gone, for who looks closer.
  [[nodiscard]] const PlayCounters& lists() const noexcept { return player_.counters(); }
  [[nodiscard]] const BoardPort& port() const noexcept { return *port_; }

 private:
  // A step that reads: a slot for each module.
  struct Reading {
    bool is_cells{false};
    std::vector<ReadSlot> slots;
    std::vector<std::optional<std::vector<std::uint16_t>>> words;  // of each slot, once fetched
  };

  // What the kick register holds: nothing that moves; a kick that waits for its scan; one that had
  // it, and would exchange the faces of modules once more with a second.
  enum class Kicked : std::uint8_t { Nothing, Waiting, Done };
  // What programs have set, as far as later ones depend on it.
  struct State {
    Kicked kicked{Kicked::Nothing};
    std::vector<CamKick> kicks{};  // of the last one
    cam_step::Count counted{};
    ScanBlock scanned{};
  };

  [[nodiscard]] Result<void> add(const CamStep& step, CamProgram& program);
  [[nodiscard]] Result<void> add_kick(const cam_step::Kick& step, CamProgram& program);
  [[nodiscard]] Result<void> add_run(CamRun options, CamProgram& program);
  [[nodiscard]] Result<void> add_within(const cam_step::Within& step);
  void visit(const ScanBlock& block, CamProgram& program);
  void send_kick_again(CamProgram& program) const;
  [[nodiscard]] Result<void> add_cells(const CamCells* cells, CamProgram& program);
  // A step that makes the kick register stand still, and is scans in which no program expects to
  // count.
  [[nodiscard]] Result<void> begin_apart(CamProgram& program);
  void end_apart(CamProgram& program) const;
  [[nodiscard]] Result<void> add_show(const cam_step::Show& step, CamProgram& program);
  void write_cells(const CamCells& cells, CamProgram& program) const;
  void read_cells(CamProgram& program);
  // Whether all that was read is here.
  [[nodiscard]] Result<bool> fetch(MonotonicTime now);
  [[nodiscard]] CamAnswer answer() const;
  [[nodiscard]] CamCells cells_of(const Reading& reading) const;
  [[nodiscard]] tl::unexpected<Error> give_up(const Error& why);

  std::unique_ptr<BoardPort> port_;
  ListPlayer player_;
  CamBoardInfo info_;
  CamGeometry geometry_{};
  std::optional<CamSpace> space_;
  bool is_set_up_{false};
  State state_;
  std::vector<ScanBlock> blocks_;  // that the program's scans visit
  bool is_running_{false};

  MonotonicTime until_{};
  std::vector<Reading> readings_;
  CamBoardCounters counters_;
};

}  // namespace thimble::cambus
