#include "drivers/falcon/falcon_match.hpp"

#include <algorithm>
#include <string>

#include "drivers/falcon/falcon_wire.hpp"
#include "drivers/falcon/find_model.hpp"

namespace thimble::falcon {
namespace {

bool has_pipe(const bus::BusDeviceInfo& info, std::uint8_t address) {
  return std::any_of(
      info.endpoints.begin(), info.endpoints.end(), [&](const bus::UsbEndpointInfo& endpoint) {
        return endpoint.interface_number == wire::kInterface && endpoint.address == address &&
               endpoint.kind == bus::UsbTransferKind::Bulk &&
               endpoint.max_packet_bytes == wire::kUsbPacketBytes;
      });
}

// Too large a value only weakens the arm; kLargest, ours, is where it is sooner a slip of the
// comma: more than fifty times the table's.
Result<double> checked_scale(const FalconModel& model, const plugin::DriverSettings& settings) {
  constexpr double kLargest = 1;
  const double said = settings.newton_per_count.value_or(model.newton_per_count);
  if (said >= model.least_newton_per_count && said <= kLargest) return said;
  return fail(Errc::InvalidArgument,
              "newton_per_count = " + std::to_string(said) + " is not from " +
                  std::to_string(model.least_newton_per_count) +
                  " to 1 N: too low a value makes every force stronger than it was asked for");
}

// There is one, and its ids tell: a name is needed by nobody.
Result<const FalconModel*> chosen_model(const std::string& name) {
  if (name.empty()) return &kFalconModels.front();
  if (const FalconModel* model = find_model(name)) return model;
  return fail(Errc::InvalidArgument, "the model '" + name + "' is unknown; a Falcon is a 'falcon'");
}

}  // namespace

Result<Match> match(const bus::BusDeviceInfo& info, const plugin::DriverSettings& settings) {
  if (info.kind != bus::BusKind::Usb || info.vendor_id != wire::kVendorId ||
      info.product_id != wire::kProductId) {
    return fail(Errc::NotMine, {});
  }
  if (!has_pipe(info, wire::kBulkIn) || !has_pipe(info, wire::kBulkOut)) {
    return fail(Errc::NotMine, "has a Falcon's ids but not its two bulk pipes of 64 bytes");
  }
  const auto model = chosen_model(settings.model);
  if (!model) return tl::unexpected<Error>(model.error());
  const auto scale = checked_scale(**model, settings);
  if (!scale) return tl::unexpected<Error>(scale.error());
  return Match{*model, *scale};
}

bus::UsbClaim claim() {
  bus::UsbClaim claim;
  claim.interface_number = wire::kInterface;
  claim.pipes.push_back({wire::kBulkIn, bus::UsbDelivery::Every});
  claim.pipes.push_back({wire::kBulkOut, bus::UsbDelivery::Newest});
  return claim;
}

}  // namespace thimble::falcon
