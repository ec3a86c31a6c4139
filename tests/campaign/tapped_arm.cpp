#include "tests/campaign/tapped_arm.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "drivers/phantom/phantom_wire.hpp"
#include "sim/model/arm/register_arm_models.hpp"
#include "sim/model/falcon/register_falcon_model.hpp"

namespace thimble::campaign {
namespace {

namespace wire = phantom::wire;

std::int16_t field(std::span<const std::uint8_t> bytes, std::size_t index) noexcept {
  const auto low = static_cast<unsigned>(bytes[2 * index]);
  const auto high = static_cast<unsigned>(bytes[2 * index + 1]);
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(low | (high << 8U)));
}

// The registry takes plain functions: one for each arm.
template <std::size_t index>
Result<std::unique_ptr<plugin::SimHidModel>> create(const plugin::SimModelSettings& settings) {
  plugin::SimModelRegistry models;
  sim::register_arm_models(models);
  auto arm = models.entries().at(index).create_hid(settings);
  if (!arm) return arm;
  return std::make_unique<TappedArm>(*std::move(arm));
}

template <std::size_t... indices>
std::vector<plugin::SimModelEntry> tapped(std::index_sequence<indices...> /*all*/) {
  plugin::SimModelRegistry models;
  sim::register_arm_models(models);
  return {{models.entries().at(indices).name, "with a tap", &create<indices>}...};
}

}  // namespace

TappedArm::TappedArm(std::unique_ptr<plugin::SimHidModel> arm)
    : arm_(std::move(arm)),
      backend_(arm_->arm_backend()),
      report_bytes_(arm_->describe().output_report_bytes) {}

WireSeen TappedArm::look() noexcept {
  const WireSeen seen = seen_;
  seen_.largest_a = {};
  return seen;
}

void TappedArm::out_report(std::span<const std::uint8_t> bytes) noexcept {
  bytes = plug_.pass(bytes, now_);
  seen_.cut = plug_.cut();
  if (bytes.size() != report_bytes_) return arm_->out_report(bytes);
  ++seen_.reports;
  seen_.last_report = now_;
  const bool is_of_currents = field(bytes, wire::kCommand) != wire::kCommandSetCounters;
  for (std::size_t motor = 0; is_of_currents && motor < 3; ++motor) {
    const double a = std::abs(0.001 * field(bytes, wire::kCurrentA + motor));
    if (a > 0) seen_.last_nonzero = now_;
    seen_.largest_a[motor] = std::max(seen_.largest_a[motor], a);
  }
  arm_->out_report(bytes);
}

std::vector<plugin::SimModelEntry> tapped_arms() {
  constexpr std::size_t kArms = 5;
  std::vector<plugin::SimModelEntry> all = tapped(std::make_index_sequence<kArms>());
  plugin::SimModelRegistry others;
  sim::register_falcon_model(others);
  all.insert(all.end(), others.entries().begin(), others.entries().end());
  return all;
}

}  // namespace thimble::campaign
