#include "drivers/cambus/pci_port.hpp"

#include <string>

#include "drivers/cambus/little_endian.hpp"

namespace thimble::cambus {
namespace {

constexpr std::uint32_t kWordBytes = 4;
constexpr std::size_t kStatusWords = page::kStatusBytes / kWordBytes;
// A board changes its words in less than a microsecond, and seldom.
constexpr int kMostLooks = 8;

}  // namespace

Result<std::unique_ptr<PciPort>> PciPort::open(std::unique_ptr<bus::MemoryWindow> window,
                                               MonotonicTime now) {
  if (window->bytes() < page::kPageBytes) {
    return fail(Errc::NotMine, "no CAM board answers: a BAR of " + std::to_string(window->bytes()) +
                                   " bytes has no page");
  }
  IdentityWords words{};
  std::uint32_t rung = 0;
  if (window->read_block(0, words) != IoStatus::Ok ||
      window->read(page::kDoorbell, rung) != IoStatus::Ok) {
    return fail(Errc::Disconnected, "the board was unplugged");
  }
  const auto facts = parse_board_facts(words, window->bytes());
  if (!facts) return tl::unexpected(facts.error());
  return std::unique_ptr<PciPort>(new PciPort(std::move(window), *facts, rung, now));
}

IoStatus PciPort::poll(MonotonicTime now, BoardStatus& out) {
  ++counters_.polls;
  IoStatus status = look_for_board(now);
  for (int i = 0; i < kMostLooks && status == IoStatus::Ok; ++i) {
    const auto seen = look_once(status);
    if (!seen) continue;
    out = *seen;
    return IoStatus::Ok;
  }
  if (status != IoStatus::Ok) return status;
  ++counters_.restless;
  return IoStatus::NoData;
}

// Is it the one that was opened, and does it live?
IoStatus PciPort::look_for_board(MonotonicTime now) {
  if (watch_.is_gone()) return IoStatus::Disconnected;
  IdentityWords words{};
  IoStatus status = note(window_->read_block(0, words));
  if (status == IoStatus::Ok) status = watch_.check_identity(words);
  return status == IoStatus::Ok ? watch_.check_beat(words, now, now) : status;
}

std::optional<BoardStatus> PciPort::look_once(IoStatus& status) {
  std::array<std::uint32_t, kStatusWords> words{};
  std::uint32_t before = 0;
  status = note(window_->read(page::kMoment, before));
  if (status != IoStatus::Ok || before % 2 != 0) return std::nullopt;
  status = note(window_->read_block(page::kRead, words));
  if (status != IoStatus::Ok || words.back() != before) return std::nullopt;
  return parse_board_status(words);
}

// The registers before the doorbell.
IoStatus PciPort::ring(const std::array<std::uint32_t, page::kHostRegisters>& registers,
                       std::uint32_t meant) {
  if (watch_.is_gone()) return IoStatus::Disconnected;
  std::uint32_t acknowledged = 0;
  IoStatus status = note(window_->read(page::kAcknowledge, acknowledged));
  // As it stands, not as we left it: another one may have rung since, or our ring was lost.
  if (status == IoStatus::Ok) status = note(window_->read(page::kDoorbell, rung_));
  if (status != IoStatus::Ok) return status;
  if (acknowledged != rung_) {
    ++counters_.held_back;
    return IoStatus::Backlogged;
  }
  status = note(window_->write_block(page::kWritten, registers));
  if (status == IoStatus::Ok) status = note(window_->write(page::kMeant, meant));
  if (status != IoStatus::Ok) return status;
  window_->barrier();
  status = note(window_->write(page::kDoorbell, rung_ + 1));
  if (status != IoStatus::Ok) return status;
  ++rung_;
  ++counters_.rings;
  return status;
}

bool PciPort::is_in_window(std::uint32_t offset, std::size_t bytes) const noexcept {
  return bytes % kWordBytes == 0 &&
         bus::lies_within(facts_.window_bytes, offset, bytes / kWordBytes);
}

IoStatus PciPort::put(std::uint32_t offset, std::span<const std::uint8_t> bytes) {
  if (watch_.is_gone()) return IoStatus::Disconnected;
  if (!is_in_window(offset, bytes.size())) return IoStatus::ProtocolError;
  words_.resize(bytes.size() / kWordBytes);
  for (std::size_t i = 0; i < words_.size(); ++i) words_[i] = load32(bytes.subspan(4 * i));
  return note(window_->write_block(facts_.window_offset + offset, words_));
}

IoStatus PciPort::get(std::uint32_t offset, std::span<std::uint8_t> bytes) {
  if (watch_.is_gone()) return IoStatus::Disconnected;
  if (!is_in_window(offset, bytes.size())) return IoStatus::ProtocolError;
  words_.resize(bytes.size() / kWordBytes);
  const IoStatus status = note(window_->read_block(facts_.window_offset + offset, words_));
  if (status != IoStatus::Ok) return status;
  for (std::size_t i = 0; i < words_.size(); ++i) store32(bytes.subspan(4 * i), words_[i]);
  return status;
}

IoStatus PciPort::note(IoStatus status) noexcept {
  return status == IoStatus::Disconnected ? watch_.give_up(Gone::Unplugged) : status;
}

}  // namespace thimble::cambus
