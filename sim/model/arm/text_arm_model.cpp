#include "sim/model/arm/text_arm_model.hpp"

#include <memory>

#include "drivers/phantom/phantom_wire.hpp"
#include "drivers/phantom/text_wire.hpp"

namespace thimble::sim {
namespace {

namespace text = phantom::text;

template <ArmParameters (*Parameters)()>
Result<std::unique_ptr<plugin::SimSerialModel>> create_arm(
    const plugin::SimModelSettings& settings) {
  const ArmParameters parameters = Parameters();
  TextFirmware::Settings board;
  board.build_number = text::build_number(parameters.name).value_or(0);
  if (settings.amplifier_max_a != 0) board.full_scale_a = settings.amplifier_max_a;
  if (!(board.full_scale_a > 0 && board.full_scale_a <= phantom::wire::kLargestCurrentA)) {
    return fail(
        Errc::InvalidArgument,
        "amplifier_max_a must be above 0 A and at most 32.767 A (0: the 6 A of the source)");
  }
  const Duration period = from_seconds(1 / text::kPwmHz);
  board.pwm_phase = static_cast<std::int64_t>(settings.seed % 100) * period / 100;
  board.is_calibration_wanted = settings.seed % 2 != 0;
  return std::make_unique<TextArmModel>(parameters, board);
}

template <ArmParameters (*Parameters)()>
void add_arm(plugin::SimModelRegistry& registry) {
  const ArmParameters arm = Parameters();
  plugin::SimModelEntry entry;
  entry.name = std::string(arm.name) + std::string(text::kSimSuffix);
  entry.description = std::string(arm.description) + " (text over USB serial)";
  entry.create_serial = &create_arm<Parameters>;
  registry.add(std::move(entry));
}

}  // namespace

TextArmModel::TextArmModel(const ArmParameters& parameters, const TextFirmware::Settings& settings)
    : BoardFirst(settings), ArmOnBoard(parameters, firmware_) {
  park();
}

bus::BusDeviceInfo TextArmModel::describe() const {
  const std::string name =
      std::string(plant().dynamics().parameters().name) + std::string(text::kSimSuffix);
  bus::BusDeviceInfo info;
  info.address = {"sim:" + name};
  info.kind = bus::BusKind::Serial;
  info.vendor_id = text::kVendorId;
  info.product_id = text::kProductId;
  info.manufacturer = "Thimble";
  info.product = "Simulated arm " + name;
  info.serial_number = "SIM-" + name;
  return info;
}

// The board reads what has come as soon as it is there.
std::size_t TextArmModel::take(std::span<const std::uint8_t> bytes) noexcept {
  const std::size_t size = firmware_.take(bytes);
  firmware_.run_until(now(), encoder_totals());
  return size;
}

std::size_t TextArmModel::give(std::span<std::uint8_t> out) noexcept { return firmware_.give(out); }

// It answers, and says nothing unasked.
MonotonicTime TextArmModel::unchanged_until() const noexcept {
  const bool has_news = firmware_.has_unread() || firmware_.has_unsaid();
  return has_news ? now() : MonotonicTime{Duration::max()};
}

void TextArmModel::power_cycle() noexcept { firmware_.power_up(now(), kBoot, encoder_totals()); }

void register_text_arm_models(plugin::SimModelRegistry& registry) {
  add_arm<&phantom_vintage_parameters>(registry);
  add_arm<&woody_2015_parameters>(registry);
  add_arm<&premium_1_5_parameters>(registry);
}

}  // namespace thimble::sim
