#include "drivers/phantom/phantom_match.hpp"

#include <cmath>
#include <string>
#include <string_view>

#include "drivers/phantom/find_model.hpp"
#include "drivers/phantom/phantom_wire.hpp"
#include "drivers/phantom/text_wire.hpp"

namespace thimble::phantom {
namespace {

bool is_text(const bus::BusDeviceInfo& info) noexcept {
  return info.kind == bus::BusKind::Serial && info.vendor_id == text::kVendorId &&
         info.product_id == text::kProductId;
}

bool has_known_ids(const bus::BusDeviceInfo& info) noexcept {
  return (info.vendor_id == wire::kMbedVendorId && info.product_id == wire::kMbedProductId) ||
         (info.vendor_id == wire::kTeensyVendorId && info.product_id == wire::kTeensyProductId);
}

Result<void> check_permission(const bus::BusDeviceInfo& info,
                              const plugin::DriverSettings& settings) {
  if (bus::is_simulated(info.address.text) || settings.is_named_by_person) return {};
  return fail(Errc::Permission,
              "'" + info.address.text +
                  "' has USB ids that many other devices share, so nothing is sent to it before a "
                  "person says that it is an arm: set the arm's device in the configuration to "
                  "its serial number or port, here \"" +
                  info.address.text + "\"");
}

Result<double> checked_amplifier(const plugin::DriverSettings& settings) {
  constexpr std::string_view kWhy =
      "it is the full scale of the controller's firmware build (3 A or 6 A are usual) and the "
      "hardware cannot tell it. Too low a value only weakens the arm; too high a value drives the "
      "amplifier beyond its range, and forces are not what was asked for";
  if (!settings.amplifier_max_a) {
    return fail(Errc::InvalidArgument, "amplifier_max_a is missing: " + std::string(kWhy));
  }
  const double full_scale_a = *settings.amplifier_max_a;
  if (!(full_scale_a > 0 && full_scale_a <= wire::kLargestCurrentA)) {
    return fail(Errc::InvalidArgument,
                "amplifier_max_a = " + std::to_string(full_scale_a) +
                    " is not above 0 and up to 32.767 A, the most the protocol can say: " +
                    std::string(kWhy));
  }
  return full_scale_a;
}

Result<const PhantomModel*> chosen_model(const bus::BusDeviceInfo& info,
                                         const plugin::DriverSettings& settings) {
  std::string name = settings.model;
  if (name.empty()) {
    name = bus::simulated_model(info.address.text);
    if (name.ends_with(text::kSimSuffix)) name.resize(name.size() - text::kSimSuffix.size());
  }
  if (const PhantomModel* model = find_model(name)) return model;
  std::string known;
  for (const PhantomModel& model : kPhantomModels) {
    known += known.empty() ? "" : ", ";
    known += model.name;
  }
  const std::string problem =
      name.empty() ? "the model is missing: the controller does not tell which arm it drives"
                   : "the model '" + name + "' is unknown";
  return fail(Errc::InvalidArgument, problem + "; known models: " + known);
}

// The text protocol is that of some arms' firmware only.
Result<void> check_text_build(const PhantomModel& model) {
  if (text::build_number(model.name)) return {};
  std::string known;
  for (const text::Build& build : text::kBuilds) {
    known += known.empty() ? "" : ", ";
    known += build.model;
  }
  return fail(Errc::InvalidArgument, "no firmware with the text protocol is known for the model '" +
                                         std::string(model.name) + "', but for: " + known);
}

Result<Match> match_known(const bus::BusDeviceInfo& info, const plugin::DriverSettings& settings) {
  if (const auto permission = check_permission(info, settings); !permission) {
    return tl::unexpected<Error>(permission.error());
  }
  const auto full_scale_a = checked_amplifier(settings);
  if (!full_scale_a) return tl::unexpected<Error>(full_scale_a.error());
  const auto model = chosen_model(info, settings);
  if (!model) return tl::unexpected<Error>(model.error());
  return Match{*model, *full_scale_a, {}};
}

}  // namespace

Result<Match> match(const bus::BusDeviceInfo& info, const plugin::DriverSettings& settings) {
  if (is_text(info)) {
    Result<Match> found = match_known(info, settings);
    if (!found) return found;
    if (const auto build = check_text_build(*found->model); !build) {
      return tl::unexpected<Error>(build.error());
    }
    return found;
  }
  if (info.kind != bus::BusKind::Hid || !has_known_ids(info)) {
    return fail(Errc::NotMine, {});
  }
  const auto form = form_of(info.input_report_bytes, info.output_report_bytes);
  if (!form) return fail(Errc::NotMine, "reports are neither 14 nor 64 bytes both ways");
  Result<Match> found = match_known(info, settings);
  if (found) found->form = form;
  return found;
}

}  // namespace thimble::phantom
