#include "sim/model/cam/plane_scan.hpp"

#include <algorithm>
#include <bit>

namespace thimble::sim::cam {

bool PlaneScan::can(const ScanPlan& plan, std::uint64_t visits, const CamTorus& torus) {
  const int log2_sites = std::countr_zero(torus.modules.front().dram.size());
  return log2_sites >= PlaneDram::kMinLog2Sites &&
         std::all_of(plan.orders.begin(), plan.orders.end(), [&](const VisitOrder& order) {
           return order.goes_in_words(visits, log2_sites) &&
                  order.is_alike_in_words(plan.orders.front());
         });
}

void PlaneScan::hold(const CamTorus& torus) {
  if (is_held_) return;
  for (std::size_t i = 0; i < torus.size(); ++i) {
    const auto& dram = torus.modules[i].dram;
    if (drams_.size() == i) drams_.emplace_back(dram.size(), *kernels_);
    drams_[i].take(dram);
  }
  is_held_ = true;
}

void PlaneScan::bring_back(CamTorus& torus) {
  tables_.clear();
  if (!is_held_) return;
  for (std::size_t i = 0; i < torus.size(); ++i) drams_[i].give(torus.modules[i].dram);
  is_held_ = false;
}

PlaneStep PlaneScan::begin(const CamTorus& torus, const ScanPlan& plan,
                           std::span<const std::size_t> which,
                           std::optional<std::size_t> looked_at) {
  hold(torus);
  tables_.resize(torus.size());
  in_force_.clear();
  for (const std::size_t i : which) {
    const CamModule& module = torus.modules[i];
    OfBank& bank = tables_[i][module.active_bank()];
    const std::uint64_t writes = module.table_writes(module.active_bank());
    if (!bank.table || bank.writes != writes) {
      bank = {writes, cache_.prepare(module.active_table())};
    }
    in_force_.push_back(bank.table);
  }
  return PlaneStep(torus, {*kernels_, plan, which, in_force_, drams_, rooms_, looked_at});
}

std::optional<std::uint64_t> PlaneScan::scan(CamTorus& torus, std::span<const std::size_t> which) {
  const ScanPlan plan = plan_scan(torus, which);
  if (!can(plan, plan.sites, torus)) {
    bring_back(torus);
    return std::nullopt;
  }
  PlaneStep step = begin(torus, plan, which, std::nullopt);
  LayerWords silence;
  const WordBlock zeros{};
  silence.fill(zeros.words.data());
  const std::uint64_t sites_of_word = plan.orders.front().sites_of_word();
  const std::uint64_t words = plan.sites / sites_of_word;
  for (std::uint64_t word = 0; word < words; word += kBlockWords) {
    step.visit(word * sites_of_word, std::min<std::uint64_t>(kBlockWords, words - word), silence);
  }
  step.finish(torus, plan.sites);
  return plan.pace.clocks();
}

std::optional<PlaneScan::Shown> PlaneScan::scan_shown(CamTorus& torus,
                                                      std::span<const std::size_t> which,
                                                      std::optional<std::size_t> looked_at) {
  const ScanPlan plan = plan_scan(torus, which);
  if (!can(plan, plan.sites, torus) || !plan.orders.front().is_in_turn_in_words()) {
    bring_back(torus);
    return std::nullopt;
  }
  PlaneStep step = begin(torus, plan, which, looked_at);
  const std::vector<std::uint16_t> silence(plan.sites);
  Shown shown{plan.pace, go_through(step, silence)};
  step.finish(torus, plan.sites);
  return shown;
}

std::optional<std::vector<std::uint16_t>> PlaneScan::scan_io(CamTorus& torus, std::size_t module,
                                                             std::span<const std::uint16_t> told) {
  const std::array<std::size_t, 1> which{module};
  const ScanPlan plan = plan_scan(torus, which);
  // What the host tells comes in turn.
  if (!can(plan, told.size(), torus) || !plan.orders.front().is_in_turn_in_words()) {
    bring_back(torus);
    return std::nullopt;
  }
  PlaneStep step = begin(torus, plan, which, 0);
  auto shown = go_through(step, told);
  step.finish(torus, told.size());
  return shown;
}

std::vector<std::uint16_t> PlaneScan::go_through(PlaneStep& step,
                                                 std::span<const std::uint16_t> told) {
  std::vector<std::uint16_t> shown(told.size());
  std::array<std::uint16_t, kBlockSites> sites{};
  LayerBlocks host{};
  LayerWords host_words{};
  std::array<Word*, kPlanes> host_out{};
  LayerWords shown_words{};
  for (std::size_t layer = 0; layer < kPlanes; ++layer) {
    host_words[layer] = host_out[layer] = host[layer].words.data();
    shown_words[layer] = rooms_.shown[layer].words.data();
  }
  for (std::size_t visited = 0; visited < told.size(); visited += kBlockSites) {
    const std::size_t count = std::min(kBlockSites, told.size() - visited);
    const auto from = static_cast<std::ptrdiff_t>(visited);
    std::copy_n(told.begin() + from, count, sites.begin());
    kernels_->from_sites(sites.data(), host_out.data());
    step.visit(visited, count / kWordSites, host_words);
    kernels_->to_sites(shown_words.data(), sites.data());
    std::copy_n(sites.begin(), count, shown.begin() + from);
  }
  return shown;
}

}  // namespace thimble::sim::cam
