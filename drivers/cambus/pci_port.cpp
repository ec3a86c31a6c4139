#include "drivers/cambus/pci_port.hpp"

#include <algorithm>
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
                                               MonotonicTime now, const PciTurn& turn) {
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
  return std::unique_ptr<PciPort>(new PciPort(std::move(window), *facts, rung, now, turn));
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

// After each of many small buffers, so that it counts.
IoStatus PciPort::confirm(MonotonicTime now) {
  left_.reads -= std::min<std::size_t>(left_.reads, page::kIdentityBytes / kWordBytes);
  return look_for_board(now);
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
  getting_.reset();
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

bool PciPort::Moving::is_it(std::uint32_t of, std::size_t bytes) const noexcept {
  return offset == of && words == bytes / kWordBytes;
}

std::uint32_t PciPort::Moving::next() const noexcept {
  return offset + static_cast<std::uint32_t>(kWordBytes * done);
}

IoStatus PciPort::put(std::uint32_t offset, std::span<const std::uint8_t> bytes) {
  if (watch_.is_gone()) return IoStatus::Disconnected;
  if (!is_in_window(offset, bytes.size())) return IoStatus::ProtocolError;
  if (!putting_ || !putting_->is_it(offset, bytes.size())) {
    putting_ = Moving{offset, bytes.size() / kWordBytes, 0};
  }
  leaving_.resize(std::min(putting_->words - putting_->done, left_.writes));
  const auto rest = bytes.subspan(kWordBytes * putting_->done);
  for (std::size_t i = 0; i < leaving_.size(); ++i) {
    leaving_[i] = load32(rest.subspan(kWordBytes * i));
  }
  const std::uint32_t at = facts_.window_offset + putting_->next();
  const IoStatus status = note(window_->write_block(at, leaving_));
  if (status != IoStatus::Ok) return status;
  left_.writes -= leaving_.size();
  putting_->done += leaving_.size();
  if (!putting_->is_done()) return IoStatus::Backlogged;
  putting_.reset();
  return status;
}

IoStatus PciPort::get(std::uint32_t offset, std::span<std::uint8_t> bytes) {
  if (watch_.is_gone()) return IoStatus::Disconnected;
  if (!is_in_window(offset, bytes.size())) return IoStatus::ProtocolError;
  if (!getting_) {
    getting_ = Moving{offset, bytes.size() / kWordBytes, 0};
    got_.resize(getting_->words);
  }
  if (!getting_->is_it(offset, bytes.size())) return IoStatus::NoData;
  const std::size_t words = std::min(getting_->words - getting_->done, left_.reads);
  const std::uint32_t at = facts_.window_offset + getting_->next();
  const IoStatus status =
      note(window_->read_block(at, std::span(got_).subspan(getting_->done, words)));
  if (status != IoStatus::Ok) return status;
  left_.reads -= words;
  getting_->done += words;
  if (!getting_->is_done()) return IoStatus::NoData;
  getting_.reset();
  for (std::size_t i = 0; i < got_.size(); ++i) store32(bytes.subspan(4 * i), got_[i]);
  return status;
}

void PciPort::drop_unsent() {
  putting_.reset();
  getting_.reset();
}

IoStatus PciPort::note(IoStatus status) noexcept {
  return status == IoStatus::Disconnected ? watch_.give_up(Gone::Unplugged) : status;
}

}  // namespace thimble::cambus
