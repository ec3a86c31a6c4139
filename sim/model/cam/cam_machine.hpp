#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sim/model/cam/cam_torus.hpp"
#include "sim/model/cam/plane_scan.hpp"
#include "sim/model/cam/sync_pulses.hpp"
#include "sim/model/cam/video_monitor.hpp"

namespace thimble::sim::cam {

struct ScanSync;

// What was asked of the machine that it answers in a way of its own, since construction.
struct CamCounters {
  std::uint64_t scans{0};
  std::uint64_t disturbed_scans{0};  // registers that wait were touched while one ran
  std::uint64_t unmodelled{0};       // registers were set to what has effects that are not modelled
  std::uint64_t site_by_site{
      0};  // scans and transfers of a fast machine that only the reference can
  bool operator==(const CamCounters&) const = default;
};

// A register was set to what has effects that are not modelled.
struct UnmodelledTouch {
  std::uint64_t at_clocks{0};
  cambus::Register of{};
  bool operator==(const UnmodelledTouch&) const = default;
};

// How bits move: as in cam_scan.hpp, site by site; or as in plane_scan.hpp wherever that can.
enum class Scanning : std::uint8_t { SiteBySite, Fast };

// The modules behind their bus, with a clock that counts what moves (docs/cambus.md, section 5).
// A scan's bits move at once when it is started, and the machine is busy until its clocks are over.
// Thread: one at a time.
class CamMachine {
 public:
  explicit CamMachine(const TorusShape& shape, Scanning scanning = Scanning::SiteBySite)
      : torus_(shape) {
    if (scanning == Scanning::Fast) planes_.emplace();
  }

  // A frame that writes to whoever is selected, and to all where the register is `select`.
  void write(std::uint32_t number, std::span<const std::uint16_t> words);
  // What the selected modules answer, ORed; nothing when none does.
  [[nodiscard]] std::optional<std::vector<std::uint16_t>> read(std::uint32_t number,
                                                               std::uint32_t length);
  void reset();
  // As the interface does: until no module scans of those that show their scan.
  void wait_for_status();
  // Until none scans.
  void wait_for_scan();
  // Not later than that: for a reset that ends whatever is under way, but for a hang.
  void be_at(std::uint64_t clocks) noexcept;
  // An injected fault: for so long nothing is done, whatever is reset.
  void hang_for(std::uint64_t clocks) { stuck_until_ = now_ += clocks; }
  // From now on scans take their clocks and move no bits: for who has the bits elsewhere.
  void keep_only_time() noexcept { moves_bits_ = false; }
  void spend(std::uint64_t clocks) { now_ += clocks; }
  // The interface's counters of lines and frames; a frame begins now.
  void set_sync(const SyncLengths& lengths) { pulses_ = SyncPulses(lengths, now_); }

  [[nodiscard]] std::uint64_t now_clocks() const noexcept { return now_; }
  // A scan runs that never ends: it waits for sync pulses, and when it began there were none.
  [[nodiscard]] bool hangs() const noexcept { return hangs_; }
  [[nodiscard]] bool is_scanning() const noexcept;
  [[nodiscard]] bool has_interrupt() const noexcept;
  [[nodiscard]] const CamCounters& counters() const noexcept { return counters_; }
  // What is on the video port: synchronized scans are seen there.
  [[nodiscard]] const VideoMonitor& monitor() const noexcept { return monitor_; }
  // The first of them; of others only the count is kept.
  static constexpr std::size_t kMostTouches = 64;
  [[nodiscard]] const std::vector<UnmodelledTouch>& unmodelled_touches() const noexcept {
    return touches_;
  }

  // An injected fault: what is never wrong here (parity, contention, a skewed scan) or has no wire
  // (multi, external). The module flags this interrupt, a bit of register 26; where it is enabled,
  // the card hears of it with the next transfer.
  void raise(std::size_t module, std::size_t interrupt) { torus_.modules[module].flag(interrupt); }

  // The inside, for tests and for what puts patterns into a world.
  // DRAM and tables as they are now; not valid after the next write() or read() of a fast machine.
  [[nodiscard]] CamTorus& torus() {
    if (planes_) planes_->bring_back(torus_);
    return torus_;
  }

 private:
  void spend_frame(std::uint32_t number, std::size_t words);
  void note_touch(cambus::Register of);
  void note_effect(cambus::Register of, std::span<const std::uint16_t> words);
  [[nodiscard]] std::vector<std::size_t> selected() const;
  void latch_selection();
  void start_scan();
  [[nodiscard]] std::uint64_t move_bits(std::span<const std::size_t> which);
  [[nodiscard]] std::uint64_t move_bits_in_sync(std::span<const std::size_t> which,
                                                const ScanSync& sync);
  [[nodiscard]] std::vector<std::uint16_t> transfer(std::size_t module,
                                                    std::span<const std::uint16_t> told);
  void write_sites(std::span<const std::uint16_t> words);

  CamTorus torus_;
  SyncPulses pulses_{};
  VideoMonitor monitor_{};
  std::optional<PlaneScan> planes_{};
  std::vector<bool> is_selected_ = std::vector<bool>(torus_.size(), false);
  std::uint64_t now_{0};
  std::uint64_t stuck_until_{0};
  std::vector<std::uint64_t> scan_ends_ = std::vector<std::uint64_t>(torus_.size(), 0);
  bool hangs_{false};
  bool moves_bits_{true};
  CamCounters counters_;
  std::vector<UnmodelledTouch> touches_;
};

}  // namespace thimble::sim::cam
