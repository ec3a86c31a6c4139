#include "hal/bus/hid_mailboxes.hpp"

#include <algorithm>
#include <array>

namespace thimble::bus {
namespace {

// Any two will do: who reads and writes here knows no endpoints.
constexpr std::uint8_t kIn = 0x81;
constexpr std::uint8_t kOut = 0x01;
constexpr std::size_t kInPipe = 0;
constexpr std::size_t kOutPipe = 1;

std::array<UsbOpenPipe, 2> two_pipes() {
  const auto pipe = [](std::uint8_t endpoint) {
    return UsbOpenPipe{{endpoint, UsbDelivery::Newest},
                       {.interface_number = 0,
                        .address = endpoint,
                        .kind = UsbTransferKind::Interrupt,
                        .max_packet_bytes = kMaxHidReportBytes,
                        .interval = 1}};
  };
  return {pipe(kIn), pipe(kOut)};
}

}  // namespace

HidMailboxes::HidMailboxes(std::size_t output_report_bytes)
    : output_report_bytes_(output_report_bytes), pipes_(two_pipes()) {}

IoStatus HidMailboxes::read_newest(HidReport& out) noexcept {
  UsbPacket packet;
  const IoStatus status = pipes_.read(kIn, packet);
  if (status != IoStatus::Ok) return status;
  out.size = packet.size;
  std::copy_n(packet.bytes.begin(), packet.size, out.bytes.begin());
  out.arrived_at = packet.arrived_at;
  out.sequence = packet.sequence;
  return IoStatus::Ok;
}

IoStatus HidMailboxes::submit(std::span<const std::uint8_t> report) noexcept {
  if (is_disconnected()) return IoStatus::Disconnected;
  if (report.size() != output_report_bytes_) return IoStatus::ProtocolError;
  return pipes_.submit(kOut, report);
}

HidCounters HidMailboxes::counters() const noexcept {
  const UsbCounters in = pipes_.counters(kIn);
  const UsbCounters out = pipes_.counters(kOut);
  return {.reports_in = in.packets_in,
          .reports_skipped = in.packets_skipped,
          .reports_out = out.packets_out,
          .writes_superseded = out.writes_superseded,
          .writes_failed = out.failures};
}

void HidMailboxes::deliver(std::span<const std::uint8_t> report, MonotonicTime at) noexcept {
  if (report.size() > kMaxHidReportBytes) return;
  pipes_.finish_in(kInPipe, UsbOutcome::Done, report, at);
}

std::span<const std::uint8_t> HidMailboxes::take_out() noexcept {
  return pipes_.take_out(kOutPipe);
}

void HidMailboxes::finish_out(bool is_taken) noexcept {
  pipes_.finish_out(kOutPipe, is_taken ? UsbOutcome::Done : UsbOutcome::Failed,
                    is_taken ? output_report_bytes_ : 0);
}

}  // namespace thimble::bus
