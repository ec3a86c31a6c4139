#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sim/model/cam/cam_torus.hpp"
#include "sim/model/cam/plane_dram.hpp"
#include "sim/model/cam/plane_step.hpp"
#include "sim/model/cam/scan_plan.hpp"
#include "sim/model/cam/table_cache.hpp"

namespace thimble::sim::cam {

// Scans as cam_scan.hpp has them, many sites at a time: the same bits, clocks, counters and
// registers. Keeps the DRAM of all modules as planes of bits from its first scan on: two bytes a
// site more, and what is in the modules is out of date until bring_back().
//
// Left to the reference: scans that visit a site twice, or words of 64 sites in parts that are not
// the same of each. Thread: one at a time. Ownership: none of the torus, which must stay the same
// one.
class PlaneScan {
 public:
  explicit PlaneScan(const VectorKernels& kernels = *usable_kernels().front())
      : kernels_(&kernels), cache_(kernels) {}

  // The clocks; nothing where it is left to the reference, for which the DRAM is then where it was.
  [[nodiscard]] std::optional<std::uint64_t> scan(CamTorus& torus,
                                                  std::span<const std::size_t> which);
  // The same, and what one of the modules shows in it, as in `which`: nothing, none is looked at.
  struct Shown {
    ScanPace pace{};
    std::vector<std::uint16_t> shown{};  // of each site in turn
  };
  [[nodiscard]] std::optional<Shown> scan_shown(CamTorus& torus, std::span<const std::size_t> which,
                                                std::optional<std::size_t> looked_at);
  // What the module's display shows; nothing as above.
  [[nodiscard]] std::optional<std::vector<std::uint16_t>> scan_io(
      CamTorus& torus, std::size_t module, std::span<const std::uint16_t> told);
  // Puts the DRAM into the modules, where whoever likes may change it and the tables.
  void bring_back(CamTorus& torus);

 private:
  struct OfBank {
    std::uint64_t writes{0};
    std::shared_ptr<const PreparedTable> table{};
  };

  [[nodiscard]] static bool can(const ScanPlan& plan, std::uint64_t visits, const CamTorus& torus);
  void hold(const CamTorus& torus);
  [[nodiscard]] PlaneStep begin(const CamTorus& torus, const ScanPlan& plan,
                                std::span<const std::size_t> which,
                                std::optional<std::size_t> looked_at);
  // Goes on through all that the host tells, in turn; what is shown meanwhile.
  [[nodiscard]] std::vector<std::uint16_t> go_through(PlaneStep& step,
                                                      std::span<const std::uint16_t> told);

  const VectorKernels* kernels_;
  TableCache cache_;
  std::vector<PlaneDram> drams_{};
  bool is_held_{false};                                           // the DRAM is in `drams_`
  std::vector<std::array<OfBank, 2>> tables_{};                   // by module
  std::vector<std::shared_ptr<const PreparedTable>> in_force_{};  // of this scan
  StepRooms rooms_{};
};

}  // namespace thimble::sim::cam
