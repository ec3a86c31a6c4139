#include "daemon/session/arm_seeker.hpp"

#include <utility>

#include "daemon/devices/arm_opener.hpp"
#include "daemon/devices/returned_arm.hpp"
#include "daemon/session/arm_settings.hpp"
#include "hal/base/check.hpp"
#include "hal/base/contain.hpp"

namespace thimble::session {

namespace {

Sought find_and_open(const Search& search) {
  Result<bus::BusDeviceInfo> found = devices::find_device(*search.buses, {search.arm.device});
  if (!found) return {std::nullopt, tl::unexpected(found.error())};
  if (search.is_look) return {*std::move(found), nullptr};
  if (search.left) {
    const Result<void> is_same = devices::check_same_device(*search.left, *found);
    if (!is_same) return {*std::move(found), tl::unexpected(is_same.error())};
  }
  plugin::DriverSettings settings = driver_settings(search.arm);
  settings.clock = search.clock;
  auto device = devices::open_found(*search.buses, *search.drivers, *found, settings);
  return {*std::move(found), std::move(device)};
}

}  // namespace

Sought seek(const Search& search) {
  Sought sought{std::nullopt, nullptr};
  const Result<void> done = contain([&] { sought = find_and_open(search); });
  if (done) return sought;
  // Whether it is there is not known; to say that it is gone would send a person to its plug.
  bus::BusDeviceInfo there;
  there.address = {search.arm.device};
  return {std::move(there), tl::unexpected(done.error().in(search.arm.device))};
}

Sought seek_and_wait(const Search& search, devices::DeviceExecutor& executor, Clock& clock) {
  constexpr Duration kLook = std::chrono::milliseconds(1);  // ours; beside an opening it is nothing
  ArmSeeker seeker(executor);
  const MonotonicTime deadline = clock.now() + kStartPatience;
  seeker.begin(search, clock.now());
  std::optional<Sought> sought = seeker.take();
  while (!sought && clock.now() < deadline) {
    static_cast<void>(clock.sleep_until(clock.now() + kLook));
    sought = seeker.take();
  }
  if (sought) return *std::move(sought);
  return {std::nullopt, fail(Errc::Timeout, seeker.lateness(clock.now()))};
}

ArmSeeker::~ArmSeeker() {
  if (std::optional<Sought> sought = take()) give_back(*std::move(sought));
}

void ArmSeeker::begin(Search search, MonotonicTime now) {
  THIMBLE_CHECK(!is_under_way());
  device_ = search.arm.device;
  begun_at_ = now;
  has_told_ = false;
  slot_ = std::make_shared<Slot>();
  executor_.post([slot = slot_, search = std::move(search)] {
    slot->sought = seek(search);
    slot->is_done.store(true);
  });
}

std::optional<Sought> ArmSeeker::take() {
  if (slot_ == nullptr || !slot_->is_done.load()) return std::nullopt;
  return std::move(std::exchange(slot_, nullptr)->sought);
}

std::string ArmSeeker::lateness(MonotonicTime now) const {
  if (!is_under_way() || now - begun_at_ < kLong) return "";
  const auto lasted = std::chrono::floor<std::chrono::seconds>(now - begun_at_);
  return device_ + ": the kernel has been opening it for " + std::to_string(lasted.count()) +
         " s: plug it in anew";
}

Result<void> ArmSeeker::tell_lateness(MonotonicTime now) {
  const std::string late = lateness(now);
  if (late.empty() || std::exchange(has_told_, true)) return {};
  return fail(Errc::Timeout, late);
}

void ArmSeeker::give_back(Sought sought) {
  if (sought.device) executor_.close(*std::move(sought.device));
}

}  // namespace thimble::session
