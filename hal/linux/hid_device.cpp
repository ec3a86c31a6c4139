#include "hal/linux/hid_device.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace thimble::linux {
namespace {

constexpr const char* kStillClosing = ": the kernel has not closed it yet";
constexpr const char* kStillOpening =
    ": the kernel has not opened it yet, since it or another HID device hangs";

}  // namespace

HidDevice::~HidDevice() { host_->close(std::move(connection_)); }

IoStatus HidDevice::submit(std::span<const std::uint8_t> report) noexcept {
  const IoStatus status = connection_->mail().submit(report);
  if (status == IoStatus::Ok || status == IoStatus::Backlogged) connection_->wake();
  return status;
}

Result<std::unique_ptr<HidDevice>> HidHost::open(const HidNodes& nodes,
                                                 const bus::BusDeviceInfo& info) {
  if (std::max(info.input_report_bytes, info.output_report_bytes) > bus::kMaxHidReportBytes) {
    return fail(Errc::Unsupported,
                info.address.text + ": it has reports of more than 64 bytes, which no arm has");
  }
  const Result<void> is_over = await_end_of_older(info.address);
  if (!is_over.has_value()) return tl::unexpected(is_over.error());
  auto started = HidConnection::start(nodes, info, settings_, opening_, *calls_);
  if (!started.has_value()) return tl::unexpected(started.error().in(info.address.text));
  std::unique_ptr<HidConnection> connection = std::move(started.value());
  const Result<void> opened = connection->opened(kPatience);
  if (opened.has_value()) return std::make_unique<HidDevice>(*this, std::move(connection));
  close(std::move(connection));
  if (opened.error().code != Errc::Timeout) {
    return tl::unexpected(opened.error().in(info.address.text));
  }
  return fail(Errc::Busy, info.address.text + kStillOpening);
}

Result<void> HidHost::await_end_of_older(const bus::DeviceAddress& address) {
  static_cast<void>(lingering());
  // Taken out, so that nobody else waits for it who opens or closes another one.
  std::vector<std::unique_ptr<HidConnection>> older = take_closing(address);
  std::erase_if(older, [](const auto& old) { return old->has_ended(kPatience); });
  if (older.empty()) return {};
  const bool is_closing = older.front()->has_opened();
  const std::lock_guard guard(closing_list_);
  std::move(older.begin(), older.end(), std::back_inserter(closing_));
  return fail(Errc::Busy, address.text + (is_closing ? kStillClosing : kStillOpening));
}

std::vector<std::unique_ptr<HidConnection>> HidHost::take_closing(
    const bus::DeviceAddress& address) {
  const std::lock_guard guard(closing_list_);
  const auto taken = std::partition(closing_.begin(), closing_.end(),
                                    [&](const auto& old) { return old->address() != address; });
  std::vector<std::unique_ptr<HidConnection>> of_it(std::make_move_iterator(taken),
                                                    std::make_move_iterator(closing_.end()));
  closing_.erase(taken, closing_.end());
  return of_it;
}

void HidHost::close(std::unique_ptr<HidConnection> connection) {
  connection->end();
  if (connection->has_ended(kClosingPatience)) return;
  const std::lock_guard guard(closing_list_);
  closing_.push_back(std::move(connection));
}

std::size_t HidHost::lingering() {
  const std::lock_guard guard(closing_list_);
  std::erase_if(closing_, [](const auto& old) { return old->has_ended(Duration(0)); });
  return closing_.size();
}

}  // namespace thimble::linux
