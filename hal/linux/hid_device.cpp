#include "hal/linux/hid_device.hpp"

#include <algorithm>
#include <utility>

namespace thimble::linux {

class HidHost::Device final : public bus::HidDevice {
 public:
  Device(HidHost& host, std::unique_ptr<HidConnection> connection) noexcept
      : host_(&host), connection_(std::move(connection)) {}
  ~Device() override { host_->close(std::move(connection_)); }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  IoStatus read_newest(bus::HidReport& out) noexcept override {
    return connection_->mail().read_newest(out);
  }
  IoStatus submit(std::span<const std::uint8_t> report) noexcept override {
    const IoStatus status = connection_->mail().submit(report);
    if (status == IoStatus::Ok || status == IoStatus::Backlogged) connection_->wake();
    return status;
  }
  [[nodiscard]] bus::HidCounters counters() const noexcept override {
    return connection_->mail().counters();
  }

 private:
  HidHost* host_;
  std::unique_ptr<HidConnection> connection_;
};

Result<std::unique_ptr<bus::HidDevice>> HidHost::open(const HidNodes& nodes,
                                                      const bus::BusDeviceInfo& info) {
  if (std::max(info.input_report_bytes, info.output_report_bytes) > bus::kMaxHidReportBytes) {
    return fail(Errc::Unsupported,
                info.address.text + ": it has reports of more than 64 bytes, which no arm has");
  }
  static_cast<void>(lingering());
  for (const std::unique_ptr<HidConnection>& old : closing_) {
    if (old->address() != info.address || old->has_ended(kPatience)) continue;
    return fail(Errc::Busy, info.address.text + ": the kernel has not closed it yet");
  }
  auto started = HidConnection::start(nodes, info, settings_, opening_);
  if (!started.has_value()) return tl::unexpected(started.error().in(info.address.text));
  std::unique_ptr<HidConnection> connection = std::move(started.value());
  const Result<void> opened = connection->opened(kPatience);
  if (opened.has_value()) return std::make_unique<Device>(*this, std::move(connection));
  close(std::move(connection));
  if (opened.error().code != Errc::Timeout) {
    return tl::unexpected(opened.error().in(info.address.text));
  }
  return fail(Errc::Busy,
              info.address.text + ": no HID device can be opened while one takes no report");
}

void HidHost::close(std::unique_ptr<HidConnection> connection) {
  connection->end();
  if (!connection->has_ended(kClosingPatience)) closing_.push_back(std::move(connection));
}

std::size_t HidHost::lingering() {
  std::erase_if(closing_, [](const auto& old) { return old->has_ended(Duration(0)); });
  return closing_.size();
}

}  // namespace thimble::linux
