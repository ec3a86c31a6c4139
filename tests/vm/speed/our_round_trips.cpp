#include <algorithm>
#include <array>
#include <cstring>

#include "tests/vm/speed/echo.hpp"
#include "tests/vm/speed/round_trips.hpp"
#include "tests/vm/speed/servo_ticks.hpp"

namespace thimble::speed {
namespace {

constexpr Duration kPatience = std::chrono::seconds(5);
constexpr std::size_t kBareTicks = 100;
using Message = std::array<std::uint8_t, kExchangeBytes>;

Message message(std::size_t number) {
  Message bytes{};
  std::memcpy(bytes.data(), &number, sizeof number);
  return bytes;
}

// `submit` sends a message, `read` puts what came into an answer: Ok when something did.
template <class Answer, class Submit, class Read>
class Exchanges {
 public:
  Exchanges(Clock& clock, std::size_t count, Submit submit, Read read)
      : clock_(clock), count_(count), submit_(submit), read_(read) {}

  // `tick_s`: processor time of a tick without a device.
  std::optional<RoundTripFigures> measured(double tick_s) {
    RoundTripFigures figures;
    for (std::size_t i = 0; i < count_; ++i) {
      const std::optional<Duration> trip = trip_by_asking();
      if (!trip) return std::nullopt;
      figures.trips_s.push_back(seconds(*trip));
    }
    const std::optional<TickWork> work = run_servo_ticks(clock_, [this] { return tick(); });
    if (!work || exchanged_ < count_) return std::nullopt;
    figures.processor_s = (work->processor_s - static_cast<double>(work->ticks) * tick_s) /
                          static_cast<double>(count_);
    return figures;
  }

 private:
  std::optional<Duration> trip_by_asking() {
    const MonotonicTime begin = clock_.now();
    if (!send()) return std::nullopt;
    while (!is_back()) {
      if (clock_.now() - begin > kPatience) return std::nullopt;
    }
    return clock_.now() - begin;
  }

  // As a driver does it in a servo's tick: what came is taken, then the next is handed over. In the
  // first one nothing is awaited.
  bool tick() {
    if (is_under_way_) {
      if (!is_back()) return true;
      if (++exchanged_ == count_) return false;
    }
    return is_under_way_ = send();
  }

  bool send() {
    sent_ = message(++number_);
    return submit_(sent_) != IoStatus::Disconnected;
  }
  bool is_back() {
    return read_(answer_) == IoStatus::Ok && std::ranges::equal(answer_.payload(), sent_);
  }

  Clock& clock_;
  std::size_t count_;
  Submit submit_;
  Read read_;
  std::size_t number_{0};
  Message sent_{};
  Answer answer_{};
  bool is_under_way_{false};
  std::size_t exchanged_{0};
};

template <class Answer, class Submit, class Read>
std::optional<RoundTripFigures> measured(Clock& clock, std::size_t count, double tick_s,
                                         Submit submit, Read read) {
  return Exchanges<Answer, Submit, Read>(clock, count, submit, read).measured(tick_s);
}

// Before anything is opened: what a servo's tick takes that does nothing.
std::optional<double> bare_tick_s(Clock& clock) {
  std::size_t left = kBareTicks;
  const std::optional<TickWork> work = run_servo_ticks(clock, [&] { return --left > 0; });
  if (!work) return std::nullopt;
  return work->processor_s / static_cast<double>(work->ticks);
}

}  // namespace

std::optional<RoundTripFigures> hid_round_trips(bus::BusEnumerator& buses,
                                                const bus::DeviceAddress& address, Clock& clock,
                                                std::size_t count) {
  const std::optional<double> tick_s = bare_tick_s(clock);
  const Result<std::unique_ptr<bus::HidDevice>> device = buses.open_hid(address);
  if (!tick_s || !device) return std::nullopt;
  return measured<bus::HidReport>(
      clock, count, *tick_s, [&](const Message& bytes) { return (*device)->submit(bytes); },
      [&](bus::HidReport& answer) { return (*device)->read_newest(answer); });
}

std::optional<RoundTripFigures> usb_round_trips(bus::BusEnumerator& buses,
                                                const bus::DeviceAddress& address, Clock& clock,
                                                std::size_t count) {
  const std::optional<double> tick_s = bare_tick_s(clock);
  bus::UsbClaim claim;
  claim.pipes.push_back({kBulkIn, bus::UsbDelivery::Newest});
  claim.pipes.push_back({kBulkOut});
  const Result<std::unique_ptr<bus::UsbDevice>> device = buses.open_usb(address, claim);
  if (!tick_s || !device) return std::nullopt;
  return measured<bus::UsbPacket>(
      clock, count, *tick_s,
      [&](const Message& bytes) { return (*device)->submit(kBulkOut, bytes); },
      [&](bus::UsbPacket& answer) { return (*device)->read(kBulkIn, answer); });
}

std::optional<RoundTripFigures> serial_round_trips(bus::BusEnumerator& buses,
                                                   const bus::DeviceAddress& address, Clock& clock,
                                                   std::size_t count) {
  const std::optional<double> tick_s = bare_tick_s(clock);
  const Result<std::unique_ptr<bus::SerialPort>> port = buses.open_serial(address, {});
  if (!tick_s || !port) return std::nullopt;
  return measured<bus::SerialChunk>(
      clock, count, *tick_s, [&](const Message& bytes) { return (*port)->submit(bytes); },
      [&](bus::SerialChunk& answer) { return (*port)->read(answer); });
}

}  // namespace thimble::speed
