#include "drivers/cambus/cam_program.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "hal/base/check.hpp"

namespace thimble::cambus {
namespace {

constexpr std::array kSetUpOnce{
    Register::SaBit,   Register::FlySrc,    Register::Display,  Register::LutIndex,
    Register::LutPerm, Register::ScanIndex, Register::Offset,   Register::IntFlags,
    Register::Verify,  Register::IntEnable, Register::ShowScan,
};

}  // namespace

CamProgram::CamProgram(const CamSpace& space, std::uint32_t base) : space_(space), builder_(base) {}

void CamProgram::number_modules() {
  constexpr LayerMask kFirst = 1;
  // All but the marked one get an id that none keeps; then the marked one is the first.
  RegisterWords others = default_words(Register::Select);
  builder_.write(others.set(field::kSelect[0], kSourceModuleId, kFirst)
                     .set(field::kSelect[1], kTargetZero, kFirst));
  builder_.write(RegisterWords(Register::ModuleId).set(field::kModuleId[0], 1));
  select(kFirst);
  builder_.write(RegisterWords(Register::ModuleId));
  for (int module = 0; module + 1 < space_.modules(); ++module) {
    const Field& pin = field::kConnect[pin_to_next(space_.board(), module)];
    select(module);
    builder_.write(default_words(Register::Connect).set(pin, kPinIs0, kFirst));
    // Whoever senses it and has no number yet.
    builder_.write(RegisterWords(Register::Select)
                       .set(field::kSelect[1], kTargetOne)
                       .set(field::kSelect[1], kTargetSpecial, kFirst));
    builder_.write(RegisterWords(Register::ModuleId)
                       .set(field::kModuleId[0], 1, static_cast<LayerMask>(module + 1)));
    select(module);
    builder_.write(default_words(Register::Connect));
  }
  select_all();
}

void CamProgram::set_up() {
  select_all();
  for (const Register number : kSetUpOnce) builder_.write(default_words(number));
  builder_.write(space_.dimension());
  builder_.write(space_.scan_format(space_.whole()));
  builder_.write(space_.scan_perm(space_.whole()));
  stand_still();
  fix(0, 0);
  set_source(Register::SiteSrc, kSelectLutOrAddress, kMapSource);
  count(Events::None);
  for (int module = 0; module < space_.modules(); ++module) {
    select(module);
    builder_.write(space_.connect(module));
  }
  // Who says when a scan ends: one is enough, they scan in lockstep.
  select(0);
  builder_.write(RegisterWords(Register::ShowScan).set(field::kShowScan[0], 1));
  select_all();
}

Result<void> CamProgram::kick(std::span<const LayerKick> kicks) {
  const auto words = space_.kick(kicks);
  if (!words) return tl::unexpected(words.error());
  builder_.write(*words);
  return {};
}

void CamProgram::load_table(std::span<const std::uint16_t> table) {
  THIMBLE_CHECK(table.size() == kTableEntries);
  builder_.write(default_words(Register::LutIndex));
  builder_.write_port(Register::LutIo, table);
}

void CamProgram::fix(LayerMask fixed, std::uint16_t bits) {
  const auto ones = static_cast<LayerMask>(fixed & bits);
  const auto zeros = static_cast<LayerMask>(fixed & ~bits);
  const auto& source = field::kSource<Register::LutSrc>;
  lut_source_.set(source[1], kMapSite).set(source[1], kMapOne, ones);
  lut_source_.set(source[1], kMapZero, zeros);
  builder_.write(lut_source_);
}

void CamProgram::count(Events events, LayerMask layers) {
  const std::uint32_t map = events == Events::Site    ? kMapSite
                            : events == Events::Table ? kMapSource
                                                      : kMapZero;
  const auto& source = field::kSource<Register::EventSrc>;
  builder_.write(RegisterWords(Register::EventSrc)
                     .set(source[0], kSelectLutOrAddress)
                     .set(source[1], kMapZero)
                     .set(source[1], map, layers));
}

void CamProgram::scan_within(const ScanBlock& block) {
  builder_.write(default_words(Register::ScanIndex));
  builder_.write(space_.scan_format(block));
  builder_.write(space_.scan_perm(block));
}

void CamProgram::run(const RunOptions& options) {
  builder_.write(RegisterWords(Register::Run)
                     .set(field::kSync, options.is_scan ? kSyncFree : kSyncNone)
                     .set(field::kNewCount, options.takes_counts ? 1 : 0)
                     .set(field::kRepeatKick, options.repeats_kick ? 1 : 0)
                     .set(field::kNewTable, options.swaps_tables ? 1 : 0));
}

std::vector<ReadSlot> CamProgram::read_counts() {
  std::vector<ReadSlot> slots;
  for (int module = 0; module < space_.modules(); ++module) {
    select(module);
    slots.push_back(builder_.read(Register::Event, kEventBits));
  }
  select_all();
  return slots;
}

void CamProgram::write_sites(int module, std::span<const std::uint16_t> sites) {
  THIMBLE_CHECK(sites.size() == std::size_t{1} << space_.log2_sector_sites());
  stand_still();
  select(module);
  set_source(Register::SiteSrc, kSelectHost, kMapSource);
  builder_.write_port(Register::ScanIo, sites);
  set_source(Register::SiteSrc, kSelectLutOrAddress, kMapSource);
  select_all();
}

ReadSlot CamProgram::read_sites(int module) {
  stand_still();
  select(module);
  set_source(Register::SiteSrc, kSelectLutOrAddress, kMapSite);
  set_source(Register::Display, kSelectLutOrAddress, kMapSite);
  const ReadSlot slot =
      builder_.read(Register::ScanIo, std::uint32_t{1} << space_.log2_sector_sites());
  set_source(Register::SiteSrc, kSelectLutOrAddress, kMapSource);
  set_source(Register::Display, kSelectLutOrAddress, kMapZero);
  select_all();
  return slot;
}

Result<void> CamProgram::show(int slice) {
  const Result<CamRaster> raster = space_.raster(slice);
  if (!raster) return tl::unexpected(raster.error());
  stand_still();
  set_source(Register::SiteSrc, kSelectLutOrAddress, kMapSite);
  set_source(Register::Display, kSelectLutOrAddress, kMapSite);
  builder_.write(default_words(Register::ScanIndex));
  builder_.write(space_.scan_format(raster->line));
  builder_.write(space_.scan_perm(raster->sector));
  bool is_first = true;
  int on_video = 0;
  select(on_video);
  for (const int module : raster->modules) {
    give_video(std::exchange(on_video, module), module);
    for (int row = 0; row < 1 << raster->sector.log2_cells[1]; ++row) {
      run_line(std::exchange(is_first, false));
    }
  }
  give_video(on_video, 0);
  select_all();
  set_source(Register::SiteSrc, kSelectLutOrAddress, kMapSource);
  set_source(Register::Display, kSelectLutOrAddress, kMapZero);
  scan_within(space_.whole());
  return {};
}

// Whoever is on video is also who says when a scan ends. `from` is selected before, `to` behind it.
// With the sweep of a row and the run of the next it has to fit into a line (video_timing.cpp).
void CamProgram::give_video(int from, int to) {
  if (from == to) return;
  builder_.write(RegisterWords(Register::ShowScan));
  select(to);
  builder_.write(RegisterWords(Register::ShowScan).set(field::kShowScan[0], 1));
}

// Line by line, as MIT's software does, with the run types that it sets for whoever listens to the
// multi pins (docs/cambus.md, section 2).
void CamProgram::run_line(bool is_first) {
  constexpr LayerMask kFrameLayer = 1U << 5;
  constexpr LayerMask kLineLayer = 1U << 10;
  builder_.write(RegisterWords(Register::Run)
                     .set(field::kSync, is_first ? kSyncFrame : kSyncLine)
                     .set(field::kRunType, 1, is_first ? kFrameLayer : kLineLayer));
}

void CamProgram::select_all() { builder_.write(default_words(Register::Select)); }

// Target n of a layer is bit n of the module's id; source 0 is the id itself.
void CamProgram::select(int module) {
  builder_.write(RegisterWords(Register::Select)
                     .set(field::kSelect[1], kTargetOne, static_cast<LayerMask>(module)));
}

void CamProgram::set_source(Register destination, std::uint32_t select, std::uint32_t map) {
  const auto fields = facts_of(destination).fields;
  builder_.write(RegisterWords(destination).set(fields[0], select).set(fields[1], map));
}

void CamProgram::stand_still() { builder_.write(RegisterWords(Register::Kick)); }

std::uint32_t count_of_layer(std::span<const std::uint16_t> words, int layer) {
  std::uint32_t count = 0;
  for (std::size_t bit = 0; bit < std::min<std::size_t>(words.size(), kEventBits); ++bit) {
    count |= ((words[bit] >> layer) & 1U) << bit;
  }
  return count;
}

}  // namespace thimble::cambus
