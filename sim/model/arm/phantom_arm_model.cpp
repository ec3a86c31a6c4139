#include "sim/model/arm/phantom_arm_model.hpp"

#include "drivers/phantom/phantom_wire.hpp"

namespace thimble::sim {
namespace {

namespace wire = phantom::wire;

ControllerFirmware::Settings firmware_settings(const ArmParameters& parameters,
                                               const plugin::SimModelSettings& settings) {
  // The board's PWM runs freely against the host's frames: any phase is as good as another.
  const std::uint64_t substeps_per_period =
      static_cast<std::uint64_t>(kPwmPeriod / PhantomArmModel::kSubstep);
  const auto phase = static_cast<std::int64_t>(settings.seed % substeps_per_period);
  return {.amplifier_max_a = settings.amplifier_max_a,
          .frame_period = wire::kSamplePeriod,
          .pwm_phase = phase * PhantomArmModel::kSubstep,
          .is_teensy = parameters.is_teensy_board};
}

}  // namespace

PhantomArmModel::PhantomArmModel(const ArmParameters& parameters,
                                 const plugin::SimModelSettings& settings)
    : BoardFirst(firmware_settings(parameters, settings)), ArmOnBoard(parameters, firmware_) {
  park();
}

bus::BusDeviceInfo PhantomArmModel::describe() const {
  const std::string name(plant().dynamics().parameters().name);
  bus::BusDeviceInfo info;
  info.address = {"sim:" + name};
  info.kind = bus::BusKind::Hid;
  const bool is_teensy = plant().dynamics().parameters().is_teensy_board;
  info.vendor_id = is_teensy ? wire::kTeensyVendorId : wire::kMbedVendorId;
  info.product_id = is_teensy ? wire::kTeensyProductId : wire::kMbedProductId;
  // Ours: no source tells the strings of a real board; a simulated one says what it is.
  info.manufacturer = "Thimble";
  info.product = "Simulated arm " + name;
  info.serial_number = "SIM-" + name;
  info.input_report_bytes = firmware_.report_bytes();
  info.output_report_bytes = firmware_.report_bytes();
  return info;
}

Duration PhantomArmModel::frame_period() const noexcept { return wire::kSamplePeriod; }

void PhantomArmModel::out_report(std::span<const std::uint8_t> bytes) noexcept {
  firmware_.out_report(now(), bytes);
}

std::size_t PhantomArmModel::in_report(std::span<std::uint8_t> out) noexcept {
  return firmware_.in_report(now(), out);
}

void PhantomArmModel::power_cycle() noexcept { firmware_.power_up(now(), kBoot, encoder_totals()); }

PhantomArmModel::Counters PhantomArmModel::counters() const noexcept {
  return {firmware_.counters(), stylus_presses(), non_finite_forces()};
}

}  // namespace thimble::sim
