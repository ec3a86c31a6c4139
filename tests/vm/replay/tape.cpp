#include "tests/vm/replay/tape.hpp"

#include <algorithm>

namespace thimble::replay {
namespace {

// FT232R, status bytes (Linux drivers/usb/serial/ftdi_sio.h): nothing is wrong.
const std::vector<std::uint8_t> kBridgeIsWell{0x01, 0x60};

}  // namespace

std::size_t TapeHid::in_report(std::span<std::uint8_t> out) noexcept {
  if (played_ >= asked_ || played_ >= tape_->reports.size()) return 0;
  const std::vector<std::uint8_t>& report = tape_->reports[played_++];
  std::copy_n(report.begin(), std::min(report.size(), out.size()), out.begin());
  return report.size();
}

plugin::UsbAnswer TapeUsb::control(const bus::UsbControlRequest&,
                                   std::span<std::uint8_t>) noexcept {
  answers_.push_back(kBridgeIsWell);
  return {plugin::UsbHandshake::Ack, 0};
}

plugin::UsbHandshake TapeUsb::out_packet(std::uint8_t, std::span<const std::uint8_t>) noexcept {
  if (played_ < tape_->reports.size()) {
    answers_.push_back(kBridgeIsWell);
    const std::vector<std::uint8_t>& reply = tape_->reports[played_++];
    answers_.back().insert(answers_.back().end(), reply.begin(), reply.end());
  }
  return plugin::UsbHandshake::Ack;
}

plugin::UsbAnswer TapeUsb::in_packet(std::uint8_t, std::span<std::uint8_t> out) noexcept {
  if (answers_.empty()) return {};
  const std::size_t size = answers_.front().size();
  std::copy_n(answers_.front().begin(), std::min(size, out.size()), out.begin());
  answers_.pop_front();
  return {plugin::UsbHandshake::Ack, size};
}

void TapeUsb::power_cycle() noexcept {
  answers_.clear();
  played_ = 0;
}

}  // namespace thimble::replay
