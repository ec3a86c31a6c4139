// How long an exchange with a device takes through hal/linux, and how much of a processor, beside a
// bare one through the same library; and the device, which sends back what it is sent.
//
// usage: vm_round_trip offer hid uhid|usb      until a signal
//        vm_round_trip offer usb|serial usb
//        vm_round_trip measure NAME hid|usb|serial ADDRESS NODE [HIDDEV]
// measure prints two lines of JSON: by the clock, and by processor time. HIDDEV: where bare reports
// leave.
#include <array>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "bench/comparison.hpp"
#include "hal/linux/bus_enumerator.hpp"
#include "hal/linux/monotonic_clock.hpp"
#include "tests/vm/offer/offer_model.hpp"
#include "tests/vm/speed/echo.hpp"
#include "tests/vm/speed/reference_round_trips.hpp"
#include "tests/vm/speed/round_trips.hpp"
#include "tests/vm/speed/servo_ticks.hpp"

namespace {

using namespace thimble;

constexpr std::size_t kTrips = 50;
constexpr double kGoal = 1.15;

Result<void> offer_of(const std::string& kind, const std::string& way) {
  if (kind == "hid") {
    speed::EchoHid hid;
    return test::offer_model(hid, hid.describe(),
                             way == "uhid" ? test::HidWay::Uhid : test::HidWay::Usb);
  }
  if (kind == "serial") {
    speed::EchoSerial serial;
    return test::offer_model(serial, serial.describe());
  }
  speed::EchoUsb usb;
  return test::offer_model(usb, usb.describe());
}

int offer(const std::string& kind, const std::string& way) {
  const Result<void> done = offer_of(kind, way);
  if (done) return 0;
  std::fprintf(stderr, "vm_round_trip: %s\n", done.error().message.c_str());
  return 1;
}

using Figures = std::optional<RoundTripFigures>;

// Both sides of one kind of bus.
struct Kind {
  const char* name;
  Figures (*ours)(bus::BusEnumerator&, const bus::DeviceAddress&, Clock&, std::size_t);
  Figures (*reference)(const ReferenceNodes&, std::size_t);
};
constexpr std::array<Kind, 3> kKinds{
    {{"hid", &speed::hid_round_trips, &reference_hid_round_trips},
     {"usb", &speed::usb_round_trips, &reference_usb_round_trips},
     {"serial", &speed::serial_round_trips, &reference_serial_round_trips}}};

Figures ours(const Kind& kind, const bus::DeviceAddress& address) {
  linux::MonotonicClock clock;
  linux::RealtimeThreadSettings threads;
  threads.name = "bus";
  linux::BusEnumerator buses({clock, threads, {}});
  return kind.ours(buses, address, clock, kTrips);
}

// On a thread of the class that ours has.
Figures bare(const Kind& kind, const ReferenceNodes& nodes) {
  Figures figures;
  if (!speed::run_as_servo([&] { figures = kind.reference(nodes, kTrips); })) return std::nullopt;
  return figures;
}

// One figure a slice.
struct Side {
  bench::Slices trips_us{};
  bench::Slices processor_us{};

  void add(const Figures& figures) {
    if (!figures) return;
    trips_us.push_back(1e6 * bench::median(figures->trips_s));
    processor_us.push_back(1e6 * figures->processor_s);
  }
};

int measure(const std::string& name, const Kind& kind, const bus::DeviceAddress& address,
            const ReferenceNodes& nodes) {
  constexpr std::size_t kTurns = 2 * bench::kSlices + 1;
  Side subject;
  Side reference;
  bench::alternate(
      kTurns, [&] { subject.add(ours(kind, address)); }, [&] { reference.add(bare(kind, nodes)); });
  if (subject.trips_us.size() != kTurns || reference.trips_us.size() != kTurns) {
    std::fprintf(stderr, "vm_round_trip: the device does not answer: %zu and %zu slices\n",
                 subject.trips_us.size(), reference.trips_us.size());
    return 1;
  }
  const bench::Goal goal{bench::Goal::Of::Ratio, kGoal};
  bench::print(bench::compare(name, "us", goal, subject.trips_us, reference.trips_us));
  bench::print(bench::compare(name + ", processor", "us", goal, subject.processor_us,
                              reference.processor_us));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() == 3 && words[0] == "offer") return offer(words[1], words[2]);
  if ((words.size() == 5 || words.size() == 6) && words[0] == "measure") {
    const bus::DeviceAddress address{words[3]};
    const ReferenceNodes nodes{words[4].c_str(), words.size() == 6 ? words[5].c_str() : nullptr};
    for (const Kind& kind : kKinds) {
      if (words[2] == kind.name) return measure(words[1], kind, address, nodes);
    }
  }
  std::fputs(
      "usage: vm_round_trip offer hid|usb|serial uhid|usb, vm_round_trip measure NAME "
      "hid|usb|serial ADDRESS NODE [HIDDEV]\n",
      stderr);
  return 2;
}
