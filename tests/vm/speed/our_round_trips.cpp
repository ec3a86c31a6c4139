#include <algorithm>
#include <array>
#include <cstring>

#include "tests/vm/speed/echo.hpp"
#include "tests/vm/speed/round_trips.hpp"

namespace thimble::speed {
namespace {

constexpr Duration kPatience = std::chrono::seconds(5);
using Message = std::array<std::uint8_t, kExchangeBytes>;

Message message(std::size_t number) {
  Message bytes{};
  std::memcpy(bytes.data(), &number, sizeof number);
  return bytes;
}

// `submit` sends a message, `read` puts what came into an answer: Ok when something did.
template <class Answer, class Submit, class Read>
std::optional<std::vector<double>> exchange(const Clock& clock, std::size_t count, Submit submit,
                                            Read read) {
  std::vector<double> trips_s;
  Answer answer;
  for (std::size_t i = 1; i <= count; ++i) {
    const Message sent = message(i);
    const MonotonicTime begin = clock.now();
    if (submit(sent) == IoStatus::Disconnected) return std::nullopt;
    while (read(answer) != IoStatus::Ok || !std::ranges::equal(answer.payload(), sent)) {
      if (clock.now() - begin > kPatience) return std::nullopt;
    }
    trips_s.push_back(seconds(clock.now() - begin));
  }
  return trips_s;
}

}  // namespace

std::optional<std::vector<double>> hid_round_trips(bus::BusEnumerator& buses,
                                                   const bus::DeviceAddress& address,
                                                   const Clock& clock, std::size_t count) {
  const Result<std::unique_ptr<bus::HidDevice>> device = buses.open_hid(address);
  if (!device) return std::nullopt;
  return exchange<bus::HidReport>(
      clock, count, [&](const Message& bytes) { return (*device)->submit(bytes); },
      [&](bus::HidReport& answer) { return (*device)->read_newest(answer); });
}

std::optional<std::vector<double>> usb_round_trips(bus::BusEnumerator& buses,
                                                   const bus::DeviceAddress& address,
                                                   const Clock& clock, std::size_t count) {
  bus::UsbClaim claim;
  claim.pipes.push_back({kBulkIn, bus::UsbDelivery::Newest});
  claim.pipes.push_back({kBulkOut});
  const Result<std::unique_ptr<bus::UsbDevice>> device = buses.open_usb(address, claim);
  if (!device) return std::nullopt;
  return exchange<bus::UsbPacket>(
      clock, count, [&](const Message& bytes) { return (*device)->submit(kBulkOut, bytes); },
      [&](bus::UsbPacket& answer) { return (*device)->read(kBulkIn, answer); });
}

std::optional<std::vector<double>> serial_round_trips(bus::BusEnumerator& buses,
                                                      const bus::DeviceAddress& address,
                                                      const Clock& clock, std::size_t count) {
  const Result<std::unique_ptr<bus::SerialPort>> port = buses.open_serial(address, {});
  if (!port) return std::nullopt;
  return exchange<bus::SerialChunk>(
      clock, count, [&](const Message& bytes) { return (*port)->submit(bytes); },
      [&](bus::SerialChunk& answer) { return (*port)->read(answer); });
}

}  // namespace thimble::speed
