#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "drivers/cambus/cam_program.hpp"
#include "drivers/cambus/step_list_check.hpp"
#include "sim/model/cam/engine/engine.hpp"
#include "sim/model/cam/step_interface.hpp"

namespace thimble::cam {

// The simulated board, register by register, behind the interface of the fast engines: every call
// is a step list of the driver that the board plays, and its clock counts. Slow; the reference.
//
// Thread: one at a time. Ownership: its own. Errors: as Engine; Unsupported for a step that leaves
// layers unwritten, InvalidArgument for a kick longer than a module.
class BoardEngine final : public sim::cam::Engine {
 public:
  // OnlyTime: no bit is moved, and what is read is nothing; the clocks are the same.
  enum class Keeps { Everything, OnlyTime };

  // `modules`: a power of two up to 64, each with a strip of the space along y.
  // Errors: InvalidArgument where such a space does not fit such a board.
  [[nodiscard]] static Result<std::unique_ptr<BoardEngine>> make(const sim::cam::SiteSpace& space,
                                                                 int modules,
                                                                 Keeps keeps = Keeps::Everything);

  [[nodiscard]] const sim::cam::SiteSpace& space() const noexcept override { return sites_; }
  Result<void> put(std::span<const std::uint16_t> sites) override;
  Result<void> get(std::span<std::uint16_t> sites) override;
  Result<void> load(std::size_t bank, std::span<const std::uint16_t> table) override;
  Result<sim::cam::PlaneCounts> step(std::span<const sim::cam::PlaneKick> kicks,
                                     const sim::cam::StepOptions& options) override;
  [[nodiscard]] sim::cam::PlaneCounts population() override;

  // Since it was made, setting up included; the last scan has ended by then.
  [[nodiscard]] std::uint64_t clocks() {
    machine_.wait_for_scan();
    return machine_.now_clocks();
  }
  // What the simulated board was told and does not do.
  [[nodiscard]] std::uint64_t unmodelled() const noexcept { return machine_.counters().unmodelled; }
  [[nodiscard]] const std::vector<sim::cam::UnmodelledTouch>& unmodelled_touches() const noexcept {
    return machine_.unmodelled_touches();
  }
  // Sends a bank's table, if it is not the one in force: steps do so themselves.
  [[nodiscard]] Result<void> show_table(std::size_t bank);

 private:
  BoardEngine(const sim::cam::SiteSpace& sites, const cambus::CamSpace& space, Keeps keeps);
  [[nodiscard]] Result<void> play(cambus::CamProgram& program);
  [[nodiscard]] std::vector<std::uint16_t> words_of(const cambus::ReadSlot& slot) const;
  [[nodiscard]] cambus::CellPlace place_of(std::size_t index) const;

  sim::cam::SiteSpace sites_;
  cambus::CamSpace space_;
  sim::cam::CamMachine machine_;
  std::vector<std::uint32_t> window_{};
  std::array<std::vector<std::uint16_t>, kBanks> tables_{};
  std::size_t bank_{kBanks};  // in force; none yet
};

}  // namespace thimble::cam
