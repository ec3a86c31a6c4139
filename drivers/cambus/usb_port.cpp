#include "drivers/cambus/usb_port.hpp"

#include <algorithm>
#include <limits>

#include "drivers/cambus/little_endian.hpp"
#include "hal/bus/memory_window.hpp"

namespace thimble::cambus {
namespace {

constexpr std::size_t kWordBytes = 4;
// Nobody says how much memory there is behind the pipes; offsets have 32 bits.
constexpr std::size_t kReach = std::numeric_limits<std::uint32_t>::max();

template <std::size_t Bytes>
std::array<std::uint32_t, Bytes / kWordBytes> words_of(const UsbFetch& fetch) {
  std::array<std::uint32_t, Bytes / kWordBytes> words{};
  const std::span<const std::uint8_t> bytes(fetch.bytes);
  for (std::size_t i = 0; i < words.size(); ++i) words[i] = load32(bytes.subspan(kWordBytes * i));
  return words;
}

const bus::UsbEndpointInfo* find(const bus::BusDeviceInfo& info, std::uint8_t address) {
  const auto found = std::find_if(
      info.endpoints.begin(), info.endpoints.end(), [&](const bus::UsbEndpointInfo& endpoint) {
        return endpoint.interface_number == usb::kInterface && endpoint.address == address &&
               endpoint.kind == bus::UsbTransferKind::Bulk;
      });
  return found == info.endpoints.end() ? nullptr : &*found;
}

}  // namespace

Result<UsbBoardMatch> match_usb_board(const bus::BusDeviceInfo& info) {
  if (info.kind != bus::BusKind::Usb || info.product != usb::kProduct) {
    return fail(Errc::NotMine, "is no CAM board on USB");
  }
  const bus::UsbEndpointInfo* const out = find(info, usb::kRequests);
  const bus::UsbEndpointInfo* const in = find(info, usb::kReplies);
  if (out == nullptr || in == nullptr || out->max_packet_bytes != in->max_packet_bytes ||
      in->max_packet_bytes < usb::kFullSpeedPacketBytes) {
    return fail(Errc::NotMine, "has a CAM board's name but not its two bulk pipes");
  }
  UsbBoardMatch match;
  match.packet_bytes = in->max_packet_bytes;
  match.claim.interface_number = usb::kInterface;
  match.claim.pipes.push_back({usb::kRequests, bus::UsbDelivery::Every});
  match.claim.pipes.push_back({usb::kReplies, bus::UsbDelivery::Every});
  return match;
}

UsbOpening::UsbOpening(std::unique_ptr<bus::UsbDevice> device, const UsbBoardMatch& match)
    : link_(std::move(device), match.packet_bytes),
      identity_(link_.read(0, page::kIdentityBytes)),
      doorbell_(link_.read(page::kDoorbell, kWordBytes)) {}

Result<std::unique_ptr<UsbPort>> UsbOpening::poll(MonotonicTime now) {
  if (link_.pump(now) != IoStatus::Ok) return fail(Errc::Disconnected, "the board was unplugged");
  if (link_.is_silent()) return fail(Errc::NotMine, "no CAM board answers: it says nothing");
  if (!doorbell_->is_here()) return fail(Errc::Busy, "the board has not said yet what it is");
  const auto facts = parse_board_facts(words_of<page::kIdentityBytes>(*identity_), kReach);
  if (!facts) return tl::unexpected(facts.error());
  const std::uint32_t rung = load32(doorbell_->bytes);
  return std::unique_ptr<UsbPort>(new UsbPort(std::move(link_), *facts, rung, now));
}

IoStatus UsbPort::pump(MonotonicTime now) {
  if (watch_.is_gone()) return IoStatus::Disconnected;
  now_ = now;
  if (link_.pump(now) != IoStatus::Ok) return watch_.give_up(Gone::Unplugged);
  return link_.is_silent() ? watch_.give_up(Gone::Silent) : IoStatus::Ok;
}

UsbPort::Fetch UsbPort::ask_for_identity() { return link_.read(0, page::kIdentityBytes); }

void UsbPort::look(MonotonicTime now) {
  Fetch status = link_.read(page::kRead, page::kStatusBytes);
  look_ = Look{std::move(status), ask_for_identity(), now};
}

IoStatus UsbPort::poll(MonotonicTime now, BoardStatus& out) {
  ++counters_.polls;
  if (!look_) look(now);
  const IoStatus pumped = pump(now);
  if (pumped != IoStatus::Ok) return pumped;
  if (!look_->identity->is_here()) return IoStatus::NoData;
  const Look seen = *std::exchange(look_, std::nullopt);
  const auto identity = words_of<page::kIdentityBytes>(*seen.identity);
  IoStatus there = watch_.check_identity(identity);
  if (there == IoStatus::Ok) there = watch_.check_beat(identity, seen.asked_at, now);
  if (there != IoStatus::Ok) return there;
  const auto words = words_of<page::kStatusBytes>(*seen.status);
  if (words.back() % 2 != 0) {
    ++counters_.restless;
    return IoStatus::NoData;
  }
  out = parse_board_status(words);
  acknowledged_ = out.acknowledged;
  if (out.is_waiting()) return IoStatus::Ok;
  // The next one will be wanted. A board that waits may be rung for instead, which nothing that is
  // under way is to hold up.
  look(now);
  return pump(now);
}

IoStatus UsbPort::confirm(MonotonicTime /*now*/) {
  // What get() hands over has been confirmed by what came behind it.
  return watch_.is_gone() ? IoStatus::Disconnected : IoStatus::Ok;
}

IoStatus UsbPort::ring(const std::array<std::uint32_t, page::kHostRegisters>& registers,
                       std::uint32_t meant) {
  if (watch_.is_gone()) return IoStatus::Disconnected;
  if (acknowledged_ != rung_) {
    ++counters_.held_back;
    return IoStatus::Backlogged;
  }
  constexpr std::size_t kBytes = page::kDoorbell + kWordBytes - page::kWritten;
  std::array<std::uint8_t, kBytes> bytes{};
  const std::span<std::uint8_t> all(bytes);
  for (std::size_t i = 0; i < registers.size(); ++i) {
    store32(all.subspan(kWordBytes * i), registers[i]);
  }
  store32(all.subspan(page::kMeant - page::kWritten), meant);
  store32(all.subspan(page::kDoorbell - page::kWritten), ++rung_);
  gots_.clear();
  look_.reset();  // what it would tell is older
  link_.write_last(page::kWritten, bytes);
  ++counters_.rings;
  return pump(now_);
}

bool UsbPort::is_in_window(std::uint32_t offset, std::size_t bytes) const noexcept {
  return offset % kWordBytes == 0 && bytes % kWordBytes == 0 &&
         bus::lies_within(facts_.window_bytes, offset, bytes / kWordBytes);
}

IoStatus UsbPort::put(std::uint32_t offset, std::span<const std::uint8_t> bytes) {
  if (watch_.is_gone()) return IoStatus::Disconnected;
  if (!is_in_window(offset, bytes.size())) return IoStatus::ProtocolError;
  if (link_.unwritten_bytes() > kMostLeftBytes) return IoStatus::Backlogged;
  gots_.clear();
  link_.write(facts_.window_offset + offset, bytes);
  return pump(now_);
}

IoStatus UsbPort::get(std::uint32_t offset, std::span<std::uint8_t> bytes) {
  if (watch_.is_gone()) return IoStatus::Disconnected;
  if (!is_in_window(offset, bytes.size())) return IoStatus::ProtocolError;
  const auto is_it = [&](const Got& got) {
    return got.offset == offset && got.bytes->bytes.size() == bytes.size();
  };
  if (std::none_of(gots_.begin(), gots_.end(), is_it)) {
    Fetch wanted = link_.read(facts_.window_offset + offset, bytes.size());
    gots_.push_back({offset, std::move(wanted), ask_for_identity()});
  }
  const IoStatus pumped = pump(now_);
  if (pumped != IoStatus::Ok) return pumped;
  const auto got = std::find_if(gots_.begin(), gots_.end(), is_it);
  if (!got->identity->is_here()) return IoStatus::NoData;
  const IoStatus is_ours = watch_.check_identity(words_of<page::kIdentityBytes>(*got->identity));
  if (is_ours != IoStatus::Ok) return is_ours;
  std::copy(got->bytes->bytes.begin(), got->bytes->bytes.end(), bytes.begin());
  gots_.erase(got);
  return IoStatus::Ok;
}

void UsbPort::drop_unsent() {
  gots_.clear();
  look_.reset();
  if (link_.drop_unsent()) --rung_;
}

}  // namespace thimble::cambus
