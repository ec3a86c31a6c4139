#include "cli/cam/board_engine.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>

namespace thimble::cam {
namespace {

using cambus::CamProgram;
using sim::cam::Counting;
using sim::cam::PlaneCounts;

// The torus of so many modules that is as even as it can be.
cambus::BoardShape board_of(const sim::cam::SiteSpace& space, int modules) {
  cambus::BoardShape board;
  const int log2_modules = std::countr_zero(static_cast<unsigned>(modules));
  for (int i = 0; i < log2_modules; ++i) ++board.log2_modules[static_cast<std::size_t>(i % 3)];
  board.log2_sites = std::max(space.log2_sites() - log2_modules, 0);
  return board;
}

CamProgram::Events events_of(Counting counting) {
  switch (counting) {
    case Counting::Nothing:
      return CamProgram::Events::None;
    case Counting::Sites:
      return CamProgram::Events::Site;
    case Counting::Outputs:
      return CamProgram::Events::Table;
  }
  return CamProgram::Events::None;
}

}  // namespace

Result<std::unique_ptr<BoardEngine>> BoardEngine::make(const sim::cam::SiteSpace& space,
                                                       int modules, Keeps keeps) {
  if (const auto checked = sim::cam::check_space(space); !checked) {
    return tl::unexpected(checked.error());
  }
  if (modules < 1 || modules > cambus::kMaxModules ||
      !std::has_single_bit(static_cast<unsigned>(modules))) {
    return fail(Errc::InvalidArgument, "a board has 1, 2, 4, 8, 16, 32 or 64 modules");
  }
  const cambus::BoardShape board = board_of(space, modules);
  if (board.log2_sites > cambus::kLog2ModuleSites.back()) {
    return fail(Errc::InvalidArgument, "a module has at most 2^24 sites: take more modules");
  }
  const auto laid_out = cambus::CamSpace::make(board, space.log2_cells, cambus::Division::StripY);
  if (!laid_out) return tl::unexpected(laid_out.error());
  auto engine = std::unique_ptr<BoardEngine>(new BoardEngine(space, *laid_out, keeps));
  CamProgram program(*laid_out);
  program.number_modules();
  program.set_up();
  if (const auto played = engine->play(program); !played) return tl::unexpected(played.error());
  return engine;
}

BoardEngine::BoardEngine(const sim::cam::SiteSpace& sites, const cambus::CamSpace& space,
                         Keeps keeps)
    : sites_(sites),
      space_(space),
      machine_({{std::size_t{1} << space.board().log2_modules[0],
                 std::size_t{1} << space.board().log2_modules[1],
                 std::size_t{1} << space.board().log2_modules[2]},
                space.board().log2_sites}) {
  if (keeps == Keeps::OnlyTime) machine_.keep_only_time();
  for (auto& table : tables_) {
    table.resize(cambus::kTableEntries);
    for (std::size_t n = 0; n < table.size(); ++n) table[n] = static_cast<std::uint16_t>(n);
  }
}

Result<void> BoardEngine::play(CamProgram& program) {
  const cambus::StepList list = program.finish();
  const auto summary = cambus::check_step_list(
      list.view(), list.head, {.module_sites = std::uint32_t{1} << space_.board().log2_sites});
  if (!summary) return tl::unexpected(summary.error());
  window_.assign((list.base + list.bytes.size() + 3) / sizeof(std::uint32_t), 0);
  std::memcpy(reinterpret_cast<char*>(window_.data()) + list.base, list.bytes.data(),
              list.bytes.size());
  sim::cam::StepInterface interface(machine_, bus::SharedWords(window_));
  interface.write_next_list(list.head);
  const bool has_ended = interface.run(summary->steps);
  if (!has_ended || interface.state() != sim::cam::StepInterface::State::Waiting) {
    return fail(Errc::System, "the simulated board stopped in the middle of a list");
  }
  return {};
}

std::vector<std::uint16_t> BoardEngine::words_of(const cambus::ReadSlot& slot) const {
  std::vector<std::uint16_t> words(slot.words);
  std::memcpy(words.data(), reinterpret_cast<const char*>(window_.data()) + slot.offset,
              words.size() * sizeof(std::uint16_t));
  return words;
}

cambus::CellPlace BoardEngine::place_of(std::size_t index) const {
  cambus::Axes at{};
  for (std::size_t axis = 0; axis < at.size(); ++axis) {
    const int log2 = sites_.log2_cells[axis];
    at[axis] = static_cast<int>(index & ((std::size_t{1} << log2) - 1));
    index >>= log2;
  }
  return space_.place_of(at);
}

Result<void> BoardEngine::put(std::span<const std::uint16_t> sites) {
  if (sites.size() != sites_.sites()) {
    return fail(Errc::InvalidArgument, "as many sites as the space has are needed");
  }
  std::vector<std::vector<std::uint16_t>> sectors(
      static_cast<std::size_t>(space_.modules()),
      std::vector<std::uint16_t>(std::size_t{1} << space_.log2_sector_sites()));
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const cambus::CellPlace place = place_of(i);
    sectors[static_cast<std::size_t>(place.module)][place.site] = sites[i];
  }
  for (int module = 0; module < space_.modules(); ++module) {
    CamProgram program(space_);
    program.write_sites(module, sectors[static_cast<std::size_t>(module)]);
    if (Result<void> played = play(program); !played) return played;
  }
  return {};
}

Result<void> BoardEngine::get(std::span<std::uint16_t> sites) {
  if (sites.size() != sites_.sites()) {
    return fail(Errc::InvalidArgument, "as many sites as the space has are needed");
  }
  std::vector<std::vector<std::uint16_t>> sectors;
  for (int module = 0; module < space_.modules(); ++module) {
    CamProgram program(space_);
    const cambus::ReadSlot slot = program.read_sites(module);
    if (Result<void> played = play(program); !played) return played;
    sectors.push_back(words_of(slot));
  }
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const cambus::CellPlace place = place_of(i);
    sites[i] = sectors[static_cast<std::size_t>(place.module)][place.site];
  }
  return {};
}

Result<void> BoardEngine::load(std::size_t bank, std::span<const std::uint16_t> table) {
  if (bank >= kBanks || table.size() != cambus::kTableEntries) {
    return fail(Errc::InvalidArgument, "a table has 65536 entries and goes into bank 0 or 1");
  }
  tables_[bank].assign(table.begin(), table.end());
  if (bank_ == bank) bank_ = kBanks;
  return {};
}

// The board swaps its two tables; one that is not in force is sent when it is asked for.
Result<void> BoardEngine::show_table(std::size_t bank) {
  if (bank >= kBanks) return fail(Errc::InvalidArgument, "there are banks 0 and 1");
  if (bank_ == bank) return {};
  CamProgram program(space_);
  program.load_table(tables_[bank]);
  program.run({.is_scan = false, .swaps_tables = true});
  if (Result<void> played = play(program); !played) return played;
  bank_ = bank;
  return {};
}

Result<PlaneCounts> BoardEngine::step(std::span<const sim::cam::PlaneKick> kicks,
                                      const sim::cam::StepOptions& options) {
  if (options.written != 0xffff) {
    return fail(Errc::Unsupported, "on a board every layer is written");
  }
  if (const auto shown = show_table(options.bank); !shown) return tl::unexpected(shown.error());
  std::vector<cambus::LayerKick> board_kicks;
  for (const auto& kick : kicks) board_kicks.push_back({kick.layers, kick.cells});
  CamProgram program(space_);
  const auto kicked = program.kick(board_kicks);
  if (!kicked) return tl::unexpected(kicked.error());
  program.fix(options.fixed, options.fixed_bits);
  program.count(events_of(options.counting));
  program.run();
  const bool counts = options.counting != Counting::Nothing;
  std::vector<cambus::ReadSlot> slots;
  if (counts) {
    program.run({.is_scan = false, .takes_counts = true});
    slots = program.read_counts();
  }
  if (const auto played = play(program); !played) return tl::unexpected(played.error());
  PlaneCounts sum{};
  for (const cambus::ReadSlot& slot : slots) {
    const auto words = words_of(slot);
    for (int layer = 0; layer < cambus::kLayers; ++layer) {
      sum[static_cast<std::size_t>(layer)] += cambus::count_of_layer(words, layer);
    }
  }
  return sum;
}

PlaneCounts BoardEngine::population() {
  std::vector<std::uint16_t> sites(sites_.sites());
  PlaneCounts counts{};
  if (!get(sites)) return counts;
  for (const std::uint16_t site : sites) {
    for (std::size_t layer = 0; layer < counts.size(); ++layer) counts[layer] += site >> layer & 1;
  }
  return counts;
}

}  // namespace thimble::cam
