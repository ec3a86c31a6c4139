#include "drivers/cambus/board.hpp"

#include <string>
#include <utility>

namespace thimble::cambus {
namespace {

static_assert(kCamTableEntries == kTableEntries);

template <class... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};
template <class... Ts>
Overloaded(Ts...) -> Overloaded<Ts...>;

// In the order of CamCells.
[[nodiscard]] Axes cell_at(const CamGeometry& geometry, std::size_t index) noexcept {
  Axes cell{};
  for (std::size_t axis = 0; axis < cell.size(); ++axis) {
    const auto bits = static_cast<unsigned>(geometry.log2_cells[axis]);
    cell[axis] = static_cast<int>(index & ((std::size_t{1} << bits) - 1));
    index >>= bits;
  }
  return cell;
}

}  // namespace

Board::Board(std::unique_ptr<BoardPort> port)
    : port_(std::move(port)),
      player_(*port_, {.module_sites = 1U << port_->facts().shape.log2_sites}),
      info_{port_->facts().shape.modules(), port_->facts().shape.log2_sites,
            port_->facts().clock_hz} {}

Result<void> Board::lay_out(const CamGeometry& geometry) {
  if (is_running_) return fail(Errc::Busy, "a program runs on the board");
  const auto space = CamSpace::make(port_->facts().shape, geometry.log2_cells, geometry.division);
  if (!space) return tl::unexpected(space.error());
  geometry_ = geometry;
  space_ = *space;
  is_set_up_ = false;
  return {};
}

Result<void> Board::start(const CamSteps& steps, Duration at_most, MonotonicTime now) {
  if (is_running_) return fail(Errc::Busy, "the program before still runs on the board");
  if (!space_) return fail(Errc::InvalidArgument, "the board has not been laid out");
  CamProgram program(*space_);
  if (!is_set_up_) {
    // After a reset alone: modules that have their numbers cannot be told from each other by it.
    if (player_.needs_set_up()) program.number_modules();
    program.set_up();
  }
  readings_.clear();
  if (!is_set_up_) state_ = {.scanned = space_->whole()};
  blocks_ = {space_->whole()};
  const State before = state_;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const auto added = add(steps[i], program);
    if (added) continue;
    state_ = before;
    ++counters_.refused;
    return tl::unexpected(added.error().in("step " + std::to_string(i)));
  }
  Result<void> started = player_.start(program.finish(), at_most, now);
  if (!started) {
    state_ = before;
    ++counters_.refused;
    return started;
  }
  is_running_ = true;
  until_ = now + at_most;
  ++counters_.started;
  return {};
}

Result<void> Board::add(const CamStep& step, CamProgram& program) {
  return std::visit(Overloaded{
                        [&](const cam_step::Kick& it) { return add_kick(it, program); },
                        [&](const cam_step::LoadTable& it) -> Result<void> {
                          if (it.table == nullptr || it.table->size() != kCamTableEntries) {
                            return fail(Errc::InvalidArgument, "a table has 65,536 entries");
                          }
                          program.load_table(*it.table);
                          return {};
                        },
                        [&](const cam_step::Fix& it) -> Result<void> {
                          program.fix(it.layers, it.bits);
                          return {};
                        },
                        [&](const cam_step::Count& it) -> Result<void> {
                          state_.counted = it;
                          program.count(it.what, it.layers);
                          return {};
                        },
                        [&](const cam_step::Run& it) { return add_run(it.options, program); },
                        [&](const cam_step::Within& it) { return add_within(it); },
                        [&](const cam_step::ReadCounts&) -> Result<void> {
                          readings_.push_back({false, program.read_counts(), {}});
                          return {};
                        },
                        [&](const cam_step::WriteCells& it) -> Result<void> {
                          if (it.cells == nullptr || it.cells->size() != geometry_.cells()) {
                            return fail(
                                Errc::InvalidArgument,
                                "the space has " + std::to_string(geometry_.cells()) + " cells");
                          }
                          return add_cells(it.cells.get(), program);
                        },
                        [&](const cam_step::ReadCells&) { return add_cells(nullptr, program); },
                        [&](const cam_step::Show& it) { return add_show(it, program); },
                    },
                    step);
}

Result<void> Board::add_kick(const cam_step::Kick& step, CamProgram& program) {
  if (state_.kicked == Kicked::Waiting) {
    return fail(Errc::InvalidArgument, "the kick before has had no scan");
  }
  state_.kicked = Kicked::Waiting;
  state_.kicks = step.kicks;
  return program.kick(step.kicks);
}

Result<void> Board::add_run(CamRun options, CamProgram& program) {
  if (options.repeats_kick && (!options.is_scan || state_.kicked == Kicked::Waiting)) {
    return fail(Errc::InvalidArgument, "a kick is repeated with a scan that has none of its own");
  }
  if (!options.is_scan) {
    program.run(options);
    return {};
  }
  if (state_.kicked == Kicked::Done && !options.repeats_kick) {
    if (Result<void> still = program.kick({}); !still) return still;
    state_.kicked = Kicked::Nothing;
  }
  if (state_.kicked == Kicked::Waiting) state_.kicked = Kicked::Done;
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    visit(blocks_[i], program);
    if (i > 0 && state_.kicked == Kicked::Done) send_kick_again(program);
    program.run(options);
    options = {};  // all but the scan has been done
  }
  return {};
}

Result<void> Board::add_within(const cam_step::Within& step) {
  blocks_ = {space_->whole()};
  if (!step.box) return {};
  const std::uint32_t rate = port_->bytes_per_s();
  const std::uint64_t clocks_a_byte = rate == 0 ? 0 : info_.clock_hz / rate;
  auto blocks = space_->blocks_around(*step.box, clocks_a_byte);
  if (!blocks) return tl::unexpected(blocks.error());
  blocks_ = *std::move(blocks);
  return {};
}

void Board::visit(const ScanBlock& block, CamProgram& program) {
  if (state_.scanned == block) return;
  program.scan_within(block);
  state_.scanned = block;
}

// Undone and sent: another part of the same step is where the first one was (docs/cambus.md,
// section 1). Both were taken before.
void Board::send_kick_again(CamProgram& program) const {
  std::vector<CamKick> back = state_.kicks;
  for (CamKick& kick : back) {
    for (int& cells : kick.cells) cells = -cells;
  }
  static_cast<void>(program.kick(back));
  static_cast<void>(program.kick(state_.kicks));
}

Result<void> Board::begin_apart(CamProgram& program) {
  if (state_.kicked == Kicked::Waiting) {
    return fail(Errc::InvalidArgument, "the kick before has had no scan");
  }
  state_.kicked = Kicked::Nothing;
  visit(space_->whole(), program);
  program.count(CamEvents::None);
  return {};
}

void Board::end_apart(CamProgram& program) const {
  program.count(state_.counted.what, state_.counted.layers);
}

// Writes them, or reads all where there are none.
Result<void> Board::add_cells(const CamCells* cells, CamProgram& program) {
  if (auto begun = begin_apart(program); !begun) return begun;
  if (cells != nullptr) {
    write_cells(*cells, program);
  } else {
    read_cells(program);
  }
  end_apart(program);
  return {};
}

Result<void> Board::add_show(const cam_step::Show& step, CamProgram& program) {
  if (!player_.video()) {
    return fail(Errc::Unsupported, "at this clock the board shows nothing on a monitor");
  }
  if (auto begun = begin_apart(program); !begun) return begun;
  if (auto shown = program.show(step.slice); !shown) return shown;
  end_apart(program);
  return {};
}

void Board::write_cells(const CamCells& cells, CamProgram& program) const {
  std::vector<std::vector<std::uint16_t>> sectors(
      static_cast<std::size_t>(space_->modules()),
      std::vector<std::uint16_t>(std::size_t{1} << space_->log2_sector_sites()));
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const CellPlace place = space_->place_of(cell_at(geometry_, i));
    sectors[static_cast<std::size_t>(place.module)][place.site] = cells[i];
  }
  for (int module = 0; module < space_->modules(); ++module) {
    program.write_sites(module, sectors[static_cast<std::size_t>(module)]);
  }
}

void Board::read_cells(CamProgram& program) {
  Reading reading{true, {}, {}};
  for (int module = 0; module < space_->modules(); ++module) {
    reading.slots.push_back(program.read_sites(module));
  }
  readings_.push_back(std::move(reading));
}

Result<std::optional<CamAnswer>> Board::poll(MonotonicTime now) {
  if (!is_running_) return fail(Errc::InvalidArgument, "no program runs on the board");
  const auto is_over = player_.poll(now);
  if (!is_over) return give_up(is_over.error());
  if (!*is_over) return std::nullopt;
  const auto is_here = fetch(now);
  if (!is_here) return give_up(is_here.error());
  if (!*is_here) return std::nullopt;
  is_running_ = false;
  is_set_up_ = true;
  ++counters_.done;
  return answer();
}

Result<bool> Board::fetch(MonotonicTime now) {
  bool is_here = true;
  for (Reading& reading : readings_) {
    reading.words.resize(reading.slots.size());
    // All are asked for before the first one comes.
    for (std::size_t i = 0; i < reading.slots.size(); ++i) {
      if (reading.words[i]) continue;
      auto words = player_.words_of(reading.slots[i], now);
      if (words) {
        reading.words[i] = *std::move(words);
        continue;
      }
      if (words.error().code != Errc::Busy) return tl::unexpected(words.error());
      is_here = false;
    }
  }
  if (is_here || now < until_) return is_here;
  return fail(Errc::Timeout, "what the program has read does not come");
}

CamAnswer Board::answer() const {
  CamAnswer answer;
  for (const Reading& reading : readings_) {
    if (reading.is_cells) {
      answer.cells.push_back(cells_of(reading));
      continue;
    }
    CamCounts counts{};
    for (const auto& words : reading.words) {
      for (std::size_t layer = 0; layer < counts.size(); ++layer) {
        counts[layer] += count_of_layer(*words, static_cast<int>(layer));
      }
    }
    answer.counts.push_back(counts);
  }
  return answer;
}

CamCells Board::cells_of(const Reading& reading) const {
  CamCells cells(geometry_.cells());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const CellPlace place = space_->place_of(cell_at(geometry_, i));
    cells[i] = (*reading.words[static_cast<std::size_t>(place.module)])[place.site];
  }
  return cells;
}

tl::unexpected<Error> Board::give_up(const Error& why) {
  is_running_ = false;
  port_->drop_unsent();
  space_.reset();
  ++counters_.failed;
  return tl::unexpected<Error>(why);
}

}  // namespace thimble::cambus
