#include "sim/model/cam/cam_machine.hpp"

#include <algorithm>
#include <bit>

#include "sim/model/cam/cam_scan.hpp"

namespace thimble::sim::cam {
namespace {

using cambus::Register;
namespace field = cambus::field;

constexpr std::uint64_t kIdle_clocks = 8;
constexpr std::uint64_t kDirection_clocks = 1;
constexpr std::uint64_t kParity_clocks = 1;
constexpr std::uint64_t kHop_clocks = 1;

bool exists(std::uint32_t number) { return number < cambus::kRegisterCount; }

bool is_set(const CamRegisters& registers, const cambus::Field& of) {
  for (std::size_t layer = 0; layer < cambus::kLayers; ++layer) {
    if (registers.get(of, layer) != 0) return true;
  }
  return false;
}

}  // namespace

void CamMachine::spend_frame(std::uint32_t number, std::size_t words) {
  now_ += kIdle_clocks + static_cast<std::uint64_t>(std::bit_width(number)) + kDirection_clocks +
          words + kParity_clocks + kHop_clocks;
}

void CamMachine::note_touch(Register of) {
  if (cambus::facts_of(of).waits && is_scanning()) ++counters_.disturbed_scans;
}

// A flywheel that is always 0 is what there is; of the environment select-read and the active table
// are.
void CamMachine::note_effect(Register of, std::span<const std::uint16_t> words) {
  const auto is_zero = [&](const cambus::Field& from, const cambus::Field& to) {
    const std::size_t end = std::min<std::size_t>(words.size(), to.first_bit + to.bits);
    const std::size_t begin = std::min<std::size_t>(from.first_bit, end);
    return std::all_of(words.begin() + static_cast<std::ptrdiff_t>(begin),
                       words.begin() + static_cast<std::ptrdiff_t>(end),
                       [](std::uint16_t word) { return word == 0; });
  };
  const auto& map = field::kSource<Register::FlySrc>[1];
  const bool is_modelled = of == Register::FlySrc ? is_zero(map, map)
                           : of == Register::Environment
                               ? is_zero(field::kEnvironment[0], field::kEnvironment[5])
                               : of != Register::Multi;
  if (is_modelled) return;
  ++counters_.unmodelled;
  if (touches_.size() < kMostTouches) touches_.push_back({now_, of});
}

std::vector<std::size_t> CamMachine::selected() const {
  std::vector<std::size_t> which;
  for (std::size_t i = 0; i < is_selected_.size(); ++i) {
    if (is_selected_[i]) which.push_back(i);
  }
  return which;
}

void CamMachine::latch_selection() {
  for (std::size_t i = 0; i < torus_.size(); ++i) {
    is_selected_[i] = torus_.modules[i].is_selected(torus_.glue_and(i));
  }
}

void CamMachine::write(std::uint32_t number, std::span<const std::uint16_t> words) {
  spend_frame(number, words.size());
  if (!exists(number)) {
    for (const std::size_t i : selected()) torus_.modules[i].note_unknown_register();
    return;
  }
  const auto of = static_cast<Register>(number);
  note_touch(of);
  note_effect(of, words);
  if (of == Register::ScanIo) return write_sites(words);
  if (of == Register::Select) {
    for (CamModule& module : torus_.modules) module.write(of, words);
    return latch_selection();
  }
  for (const std::size_t i : selected()) torus_.modules[i].write(of, words);
  if (of == Register::Run) start_scan();
}

std::optional<std::vector<std::uint16_t>> CamMachine::read(std::uint32_t number,
                                                           std::uint32_t length) {
  spend_frame(number, length);
  spend(kHop_clocks);
  std::vector<std::size_t> talkers = selected();
  if (exists(number) && static_cast<Register>(number) == Register::Select) {
    talkers.clear();
    for (std::size_t i = 0; i < torus_.size(); ++i) {
      if (is_set(torus_.modules[i].registers, field::kEnvironment[6])) talkers.push_back(i);
    }
  }
  if (talkers.empty()) return std::nullopt;
  std::vector<std::uint16_t> words(length);
  if (!exists(number)) {
    for (const std::size_t i : talkers) torus_.modules[i].note_unknown_register();
    return words;
  }
  const auto of = static_cast<Register>(number);
  note_touch(of);
  const std::vector<std::uint16_t> silence(length);
  for (const std::size_t i : talkers) {
    const auto said =
        of == Register::ScanIo ? transfer(i, silence) : torus_.modules[i].read(of, length);
    std::transform(words.begin(), words.end(), said.begin(), words.begin(),
                   [](std::uint16_t a, std::uint16_t b) { return std::uint16_t(a | b); });
  }
  return words;
}

void CamMachine::write_sites(std::span<const std::uint16_t> words) {
  for (const std::size_t i : selected()) static_cast<void>(transfer(i, words));
}

std::uint64_t CamMachine::move_bits(std::span<const std::size_t> which) {
  if (!planes_ || !moves_bits_) return scan(torus_, which, moves_bits_);
  if (const auto clocks = planes_->scan(torus_, which)) return *clocks;
  ++counters_.site_by_site;
  return scan(torus_, which);
}

std::uint64_t CamMachine::move_bits_in_sync(std::span<const std::size_t> which,
                                            const ScanSync& sync) {
  if (!planes_ || !moves_bits_) return scan(torus_, which, moves_bits_, &sync);
  const auto on_video = module_on_video(torus_, which);
  const auto scanned = planes_->scan_shown(torus_, which, on_video);
  if (!scanned) {
    ++counters_.site_by_site;
    return scan(torus_, which, true, &sync);
  }
  std::uint64_t at = now_;
  for (std::uint64_t sweep = 0; sweep < scanned->pace.sweeps; ++sweep) {
    const bool waits_for_frame = sweep == 0 && sync.mode == cambus::kSyncFrame;
    at = waits_for_frame ? pulses_.next_frame(at) : pulses_.next_line(at);
    const auto seen =
        std::span(scanned->shown)
            .subspan(sweep * scanned->pace.sites_a_sweep, scanned->pace.sites_a_sweep);
    if (on_video) monitor_.draw(pulses_.place_of(at), seen);
    at += scanned->pace.clocks_of_sweep(sweep);
  }
  return at - now_;
}

std::vector<std::uint16_t> CamMachine::transfer(std::size_t module,
                                                std::span<const std::uint16_t> told) {
  if (!planes_) return scan_io(torus_, module, told);
  if (auto shown = planes_->scan_io(torus_, module, told)) return *std::move(shown);
  ++counters_.site_by_site;
  return scan_io(torus_, module, told);
}

void CamMachine::start_scan() {
  std::vector<std::size_t> which;
  std::uint32_t mode = cambus::kSyncNone;
  for (const std::size_t i : selected()) {
    const std::uint32_t sync = torus_.modules[i].registers.get(field::kSync, 0);
    if (sync == cambus::kSyncNone) continue;
    if (sync != cambus::kSyncFree && !pulses_.run()) hangs_ = true;
    if (which.empty()) mode = sync;
    which.push_back(i);
  }
  if (hangs_ || which.empty()) return;
  ++counters_.scans;
  const ScanSync sync{pulses_, now_, mode, monitor_};
  const std::uint64_t end =
      now_ + (mode == cambus::kSyncFree ? move_bits(which) : move_bits_in_sync(which, sync));
  for (const std::size_t i : which) {
    scan_ends_[i] = end;
    torus_.modules[i].registers.planes(Register::Run) = {};
  }
}

void CamMachine::wait_for_status() {
  for (std::size_t i = 0; i < torus_.size(); ++i) {
    if (shows_scan(torus_.modules[i])) now_ = std::max(now_, scan_ends_[i]);
  }
}

void CamMachine::wait_for_scan() {
  now_ = std::max(now_, *std::max_element(scan_ends_.begin(), scan_ends_.end()));
}

bool CamMachine::is_scanning() const noexcept {
  return hangs_ || std::any_of(scan_ends_.begin(), scan_ends_.end(),
                               [this](std::uint64_t end) { return end > now_; });
}

void CamMachine::be_at(std::uint64_t clocks) noexcept {
  now_ = std::min(now_, std::max(clocks, stuck_until_));
  for (std::uint64_t& end : scan_ends_) end = std::min(end, now_);
}

void CamMachine::reset() {
  for (CamModule& module : torus_.modules) module.reset();
  hangs_ = false;
  std::fill(scan_ends_.begin(), scan_ends_.end(), now_);
  latch_selection();
}

bool CamMachine::has_interrupt() const noexcept {
  return std::any_of(torus_.modules.begin(), torus_.modules.end(),
                     [](const CamModule& module) { return module.has_interrupt(); });
}

}  // namespace thimble::sim::cam
