#include "daemon/session/arm_opening.hpp"

#include <utility>

#include "daemon/devices/open_arm.hpp"
#include "daemon/devices/returned_arm.hpp"
#include "daemon/session/arm_settings.hpp"
#include "hal/base/check.hpp"
#include "hal/base/contain.hpp"

namespace thimble::session {
namespace {

OpenOutcome find_and_open(const OpenRequest& request) {
  Result<bus::BusDeviceInfo> found = devices::find_device(*request.buses, {request.arm.device});
  if (!found) return NotThere{found.error()};
  if (request.probe_only) return Probed{};
  if (request.left) {
    const Result<void> is_same = devices::check_same_device(*request.left, *found);
    if (!is_same) return Refused{is_same.error()};
  }
  plugin::DriverSettings settings = driver_settings(request.arm);
  settings.clock = request.clock;
  auto device = devices::open_found(*request.buses, *request.drivers, *found, settings);
  if (!device) return Refused{device.error()};
  return Opened{*std::move(found), *std::move(device)};
}

}  // namespace

OpenOutcome open_now(const OpenRequest& request) {
  Result<OpenOutcome> outcome = contain([&] { return find_and_open(request); });
  if (outcome) return *std::move(outcome);
  // Whether it is there is not known; to say that it is gone would send a person to its plug.
  return Refused{outcome.error().in(request.arm.device)};
}

Result<Opened> opened_of(OpenOutcome outcome) {
  if (auto* opened = std::get_if<Opened>(&outcome)) return std::move(*opened);
  if (auto* absent = std::get_if<NotThere>(&outcome)) return tl::unexpected(absent->why);
  THIMBLE_CHECK(std::holds_alternative<Refused>(outcome));
  return tl::unexpected(std::get<Refused>(outcome).why);
}

OpenOutcome open_and_wait(const OpenRequest& request, devices::DeviceExecutor& executor,
                          Clock& clock) {
  constexpr Duration kLook = std::chrono::milliseconds(1);  // ours; beside an opening it is nothing
  ArmOpener opener(executor);
  const MonotonicTime deadline = clock.now() + kStartPatience;
  opener.begin(request, clock.now());
  std::optional<OpenOutcome> outcome = opener.take();
  while (!outcome && clock.now() < deadline) {
    static_cast<void>(clock.sleep_until(clock.now() + kLook));
    outcome = opener.take();
  }
  if (outcome) return *std::move(outcome);
  return Refused{{Errc::Timeout, opener.lateness(clock.now())}};
}

ArmOpener::~ArmOpener() {
  // Whoever is the last to hold it, it ends there, be it done by now or not.
  if (slot_ != nullptr) executor_.post([slot = std::move(slot_)]() mutable { slot.reset(); });
}

void ArmOpener::begin(OpenRequest request, MonotonicTime now) {
  THIMBLE_CHECK(!is_under_way());
  device_ = request.arm.device;
  begun_at_ = now;
  has_told_ = false;
  slot_ = std::make_shared<Slot>();
  executor_.post([slot = slot_, request = std::move(request)] {
    slot->outcome = open_now(request);
    slot->is_done.store(true);
  });
}

std::optional<OpenOutcome> ArmOpener::take() {
  if (slot_ == nullptr || !slot_->is_done.load()) return std::nullopt;
  return std::move(std::exchange(slot_, nullptr)->outcome);
}

std::string ArmOpener::lateness(MonotonicTime now) const {
  if (!is_under_way() || now - begun_at_ < kLong) return "";
  const auto lasted = std::chrono::floor<std::chrono::seconds>(now - begun_at_);
  return device_ + ": the kernel has been opening it for " + std::to_string(lasted.count()) +
         " s: plug it in anew";
}

Result<void> ArmOpener::tell_lateness(MonotonicTime now) {
  const std::string late = lateness(now);
  if (late.empty() || std::exchange(has_told_, true)) return {};
  return fail(Errc::Timeout, late);
}

void ArmOpener::give_back(OpenOutcome outcome) {
  if (auto* opened = std::get_if<Opened>(&outcome)) executor_.close(std::move(opened->device));
}

}  // namespace thimble::session
