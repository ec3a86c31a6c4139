#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "drivers/cambus/list_player.hpp"
#include "drivers/cambus/usb_port.hpp"
#include "hal/base/check.hpp"
#include "sim/model/cam/cam_usb_model.hpp"

namespace {

namespace cambus = thimble::cambus;
namespace usb = thimble::cambus::usb;
using thimble::IoStatus;
using thimble::plugin::UsbHandshake;

// What the input does to each packet of a sound board: passes it on, loses it, doubles it, cuts it,
// spoils it, or puts bytes of its own in its place.
class Meddler {
 public:
  explicit Meddler(std::span<const std::uint8_t> input) : rest_(input) {}

  enum class What : std::uint8_t { Pass, Lose, Double, Cut, Refuse, Spoil, Replace, Wait };
  What next() {
    const auto what = static_cast<What>(byte() % 8);
    if (what == What::Spoil || what == What::Replace) is_forging_ = true;
    return what;
  }
  std::uint8_t byte() {
    if (rest_.empty()) return 0;
    const std::uint8_t byte = rest_.front();
    rest_ = rest_.subspan(1);
    return byte;
  }
  [[nodiscard]] bool is_over() const noexcept { return rest_.empty(); }
  // Bytes of its own were passed off as the board's, or the host's.
  [[nodiscard]] bool is_forging() const noexcept { return is_forging_; }

 private:
  std::span<const std::uint8_t> rest_;
  bool is_forging_{false};
};

class MeddledDevice final : public thimble::bus::UsbDevice {
 public:
  MeddledDevice(thimble::sim::cam::CamUsbModel& model, Meddler& meddler)
      : model_(&model), meddler_(&meddler) {}

  IoStatus read(std::uint8_t endpoint, thimble::bus::UsbPacket& out) noexcept override {
    THIMBLE_CHECK(endpoint == usb::kReplies);
    const Meddler::What what = meddler_->next();
    if (what == Meddler::What::Wait) return IoStatus::NoData;
    if (what != Meddler::What::Double && !fetch()) return IoStatus::NoData;
    out.bytes = last_;
    out.size = size_;
    if (what == Meddler::What::Lose) return read(endpoint, out);
    if (what == Meddler::What::Cut) out.size = size_ / 2;
    if (what == Meddler::What::Spoil) out.bytes[meddler_->byte() % 64] ^= meddler_->byte();
    if (what == Meddler::What::Replace) {
      out.size = meddler_->byte() % 65;
      for (std::size_t i = 0; i < out.size; ++i) out.bytes[i] = meddler_->byte();
    }
    out.sequence = ++sequence_;
    return IoStatus::Ok;
  }
  IoStatus submit(std::uint8_t endpoint, std::span<const std::uint8_t> packet) noexcept override {
    THIMBLE_CHECK(endpoint == usb::kRequests && !packet.empty() && packet.size() <= 64);
    const Meddler::What what = meddler_->next();
    if (what == Meddler::What::Wait) return IoStatus::Backlogged;
    if (what == Meddler::What::Lose) return IoStatus::Ok;
    if (what == Meddler::What::Refuse) {
      ++stalls_;
      return IoStatus::Ok;
    }
    std::vector<std::uint8_t> bytes(packet.begin(), packet.end());
    if (what == Meddler::What::Cut) bytes.resize((bytes.size() + 1) / 2);
    if (what == Meddler::What::Spoil) bytes[meddler_->byte() % bytes.size()] ^= meddler_->byte();
    if (model_->out_packet(endpoint, bytes) == UsbHandshake::Nak) return IoStatus::Backlogged;
    if (what == Meddler::What::Double) static_cast<void>(model_->out_packet(endpoint, bytes));
    return IoStatus::Ok;
  }
  IoStatus start_control(const thimble::bus::UsbControlRequest& /*request*/) noexcept override {
    return IoStatus::ProtocolError;
  }
  IoStatus read_control(thimble::bus::UsbControlReply& /*out*/) noexcept override {
    return IoStatus::NoData;
  }
  [[nodiscard]] thimble::bus::UsbCounters counters(std::uint8_t endpoint) const noexcept override {
    return {.stalls = endpoint == usb::kRequests ? stalls_ : 0};
  }

 private:
  bool fetch() noexcept {
    const auto answer = model_->in_packet(usb::kReplies, std::span(last_).first(64));
    size_ = answer.size;
    return answer.handshake == UsbHandshake::Ack;
  }

  thimble::sim::cam::CamUsbModel* model_;
  Meddler* meddler_;
  std::array<std::uint8_t, thimble::bus::kMaxUsbPacketBytes> last_{};
  std::size_t size_{0};
  std::uint64_t sequence_{0};
  std::uint64_t stalls_{0};
};

// Puts bytes and gets them: they come as they were put, or not at all. Whether it did.
bool exchange(cambus::UsbPort& port, thimble::MonotonicTime& now, std::uint8_t seed,
              const Meddler& meddler) {
  std::array<std::uint8_t, 200> put{};
  for (std::uint8_t i = 0; i < put.size(); ++i) put[i] = static_cast<std::uint8_t>(i * 7 + seed);
  if (port.put(64, put) != IoStatus::Ok) return false;
  std::array<std::uint8_t, put.size()> got{};
  cambus::BoardStatus status;
  for (int i = 0; i < 1000; ++i) {
    now = now + std::chrono::milliseconds(1);
    static_cast<void>(port.poll(now, status));
    const IoStatus said = port.get(64, got);
    THIMBLE_CHECK(said != IoStatus::ProtocolError);
    if (said == IoStatus::Disconnected) return false;
    if (said != IoStatus::Ok) continue;
    THIMBLE_CHECK(got == put || meddler.is_forging());
    return true;
  }
  // Patience is shorter than that: it answers, or it is given up.
  THIMBLE_CHECK(!meddler.is_over());
  return false;
}

}  // namespace

// Whatever is done to the packets, nobody waits for ever and nothing false is taken for true.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  thimble::MonotonicTime now{};
  thimble::sim::cam::CamUsbModel model({.shape = {{1, 1, 1}, 4}, .window_bytes = 0x2000});
  model.advance(now);
  Meddler meddler(std::span(data, size));
  const auto match = cambus::match_usb_board([&] {
    auto info = model.describe();
    info.kind = thimble::bus::BusKind::Usb;
    return info;
  }());
  cambus::UsbOpening opening(std::make_unique<MeddledDevice>(model, meddler), match.value());
  auto port = opening.poll(now);
  while (!port && port.error().code == thimble::Errc::Busy) {
    now = now + std::chrono::milliseconds(1);
    model.advance(now);
    port = opening.poll(now);
  }
  if (!port) return 0;
  for (std::uint8_t i = 0; i < 20; ++i) {
    if (!exchange(**port, now, i, meddler)) break;
    model.advance(now);
  }
  return 0;
}
