// Plays the recorded reports of an arm to a session, one a tick, over a bus of any kind; or offers
// the device that says them to a kernel.
//
// usage: vm_replay play ARM sim|ADDRESS    prints a line for each tick
//        vm_replay offer ARM uhid|usb      until a signal
//
// The tape is recorded anew by each of them: a simulated session is the same every time.
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "hal/linux/bus_enumerator.hpp"
#include "hal/linux/monotonic_clock.hpp"
#include "sim/bus/sim_enumerator.hpp"
#include "tests/vm/replay/offer.hpp"
#include "tests/vm/replay/session.hpp"

namespace {

using namespace thimble;

constexpr const char* kSerial = "VM-TAPE-1";

Result<std::string> play_simulated(const replay::Arm& arm, const replay::Tape& tape) {
  sim::VirtualClock clock;
  sim::SimEnumerator buses(clock);
  const bool is_usb = tape.info.kind == bus::BusKind::Usb;
  const std::string device = is_usb ? "usb:1-1" : std::string("hid:") + kSerial;
  const Result<void> plugged = is_usb
                                   ? buses.plug({device}, std::make_unique<replay::TapeUsb>(tape))
                                   : buses.plug({device}, std::make_unique<replay::TapeHid>(tape));
  if (!plugged) return tl::unexpected(plugged.error());
  return replay::play(arm, device, buses, clock, replay::Pace::Virtual);
}

Result<std::string> play_real(const replay::Arm& arm, const std::string& device) {
  const linux::MonotonicClock machine;
  linux::RealtimeThreadSettings threads;
  threads.name = "bus";
  linux::BusEnumerator buses({machine, threads, {}});
  sim::VirtualClock clock;
  return replay::play(arm, device, buses, clock, replay::Pace::Waits);
}

Result<void> run(const std::vector<std::string>& words) {
  const Result<replay::Arm> arm = replay::find_arm(words[1]);
  if (!arm) return tl::unexpected(arm.error());
  Result<replay::Tape> tape = replay::record(*arm);
  if (!tape) return tl::unexpected(tape.error());
  tape->info.serial_number = kSerial;
  if (words[0] == "offer") {
    return replay::offer(*tape, words[2] == "uhid" ? test::HidWay::Uhid : test::HidWay::Usb);
  }
  const Result<std::string> lines =
      words[2] == "sim" ? play_simulated(*arm, *tape) : play_real(*arm, words[2]);
  if (!lines) return tl::unexpected(lines.error());
  std::fputs(lines->c_str(), stdout);
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() != 3 || (words[0] != "play" && words[0] != "offer")) {
    std::fputs("usage: vm_replay play ARM sim|ADDRESS, vm_replay offer ARM uhid|usb\n", stderr);
    return 2;
  }
  const Result<void> done = run(words);
  if (done) return 0;
  std::fprintf(stderr, "vm_replay: %s\n", done.error().message.c_str());
  return 1;
}
