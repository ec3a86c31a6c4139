#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "drivers/cambus/cam_space.hpp"
#include "drivers/cambus/step_list_builder.hpp"

namespace thimble::cambus {

using LookupTable = CamTable;
using RunOptions = CamRun;

// A run of layers that a rule takes for a number.
[[nodiscard]] constexpr LayerMask layers(int first, int last) noexcept {
  return static_cast<LayerMask>(((2U << last) - 1U) & ~((1U << first) - 1U));
}

// Programs of a cellular automaton as step lists: what a scan does is set once and holds for all
// that follow. Pure. Thread: one at a time. Calls with a table of another size, or of layers that
// are not there, are mistakes of the caller.
class CamProgram {
 public:
  explicit CamProgram(const CamSpace& space, std::uint32_t base = wire::kReservedBytes);

  // Gives each module its number, from the one that is marked after a reset on (docs/cambus.md,
  // register 23), over the glue wires between them.
  void number_modules();
  // Every register of every module, with nothing moving, every bit through the table, and nothing
  // counted or shown.
  void set_up();

  // Layers that are not named stand still.
  Result<void> kick(std::span<const LayerKick> kicks);
  // Into the inactive table of all modules; a run swaps them.
  void load_table(std::span<const std::uint16_t> table);
  // The table is told these constants instead of the bits of some layers; the sites keep theirs.
  void fix(LayerMask fixed, std::uint16_t bits);
  using Events = CamEvents;
  void count(Events events, LayerMask layers = kAllLayers);
  // What the runs that follow visit: parts of one step of the whole space, or a step of which
  // nothing is elsewhere. The kick of a step is undone and sent again before each of its parts but
  // the first. Sites are written and read with the whole.
  void scan_within(const ScanBlock& block);
  void run(const RunOptions& options = {});
  // One slot of 25 words for each module, in order: word k has bit k of the 16 counts, as of the
  // last run that took them.
  [[nodiscard]] std::vector<ReadSlot> read_counts();

  // All sites of one module in the order of their addresses; nothing may be kicked.
  void write_sites(int module, std::span<const std::uint16_t> sites);
  [[nodiscard]] ReadSlot read_sites(int module);

  // A slice of the space, whose number along z is `slice`, on a monitor, once: from a frame's
  // beginning on, a line of cells in each of its lines, as the space is now. Nothing may be kicked,
  // nothing is counted, no table is used, and every cell stays as it is; then everything is
  // visited again. Takes the rest of a frame and as many lines as there are rows.
  // Errors: InvalidArgument, no such slice, or x is divided among modules; TooLarge, the monitor
  // has fewer or shorter lines.
  Result<void> show(int slice);

  void delay(std::uint32_t clocks) { builder_.delay(clocks); }
  // The list so far; what is set holds for the next one.
  [[nodiscard]] StepList finish() { return builder_.finish(); }

 private:
  void select_all();
  void select(int module);
  void set_source(Register destination, std::uint32_t select, std::uint32_t map);
  void stand_still();
  void give_video(int from, int to);
  void run_line(bool is_first);

  CamSpace space_;
  StepListBuilder builder_;
  RegisterWords lut_source_{default_words(Register::LutSrc)};
};

// A count out of the words that read_counts() brought, of one module.
[[nodiscard]] std::uint32_t count_of_layer(std::span<const std::uint16_t> words, int layer);

}  // namespace thimble::cambus
